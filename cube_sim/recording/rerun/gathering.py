"""Several batches handed on as one, for a file that prefers few large pieces to many small ones."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from cube_sim.recording.batch import Batch, Rows, View, batch_number
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import LogLine


class GatheringSink:
    """Hands batches on in pieces of so many simulated seconds.

    Pieces end where the time is a multiple of their length, however the batches arrive.
    """

    def __init__(self, sink: View, seconds: int) -> None:
        self._sink = sink
        self._seconds = seconds
        self._piece: int | None = None
        self._rows: dict[str, list[Rows]] = {}
        self._log: list[LogLine] = []

    def write(self, batch: Batch) -> None:
        """Keep a batch, and hand on the piece before it when it begins a new one."""
        piece = batch_number(_start(batch)) // self._seconds
        if piece != self._piece:
            self._hand_on()
            self._piece = piece
        for name, rows in batch.rows.items():
            self._rows.setdefault(name, []).append(rows)
        self._log += batch.log

    def tell(self, end: RunEnd) -> None:
        """Hand on what is left, and how the run ended."""
        self._hand_on()
        self._sink.tell(end)

    def close(self) -> None:
        """Hand on what is left and finish the sink."""
        try:
            self._hand_on()
        finally:
            self._sink.close()

    def _hand_on(self) -> None:
        if self._rows or self._log:
            rows = {name: np.concatenate(parts) for name, parts in self._rows.items()}
            batch, self._rows, self._log = Batch(rows, self._log), {}, []
            self._sink.write(batch)


def gathered(batches: Iterable[Batch], seconds: int) -> list[Batch]:
    """The same rows in pieces of so many simulated seconds, at least one piece."""
    pieces = _Pieces()
    sink = GatheringSink(pieces, seconds)
    for batch in batches:
        sink.write(batch)
    sink.close()
    return pieces.taken or [Batch({})]


class _Pieces:
    """Keeps what it is handed."""

    def __init__(self) -> None:
        self.taken: list[Batch] = []

    def write(self, batch: Batch) -> None:
        self.taken.append(batch)

    def tell(self, end: RunEnd) -> None:
        pass

    def close(self) -> None:
        pass


def _start(batch: Batch) -> float:
    """Find the earliest instant [s] of a batch."""
    return min([rows[0, 0] for rows in batch.rows.values()] + [line.t for line in batch.log])
