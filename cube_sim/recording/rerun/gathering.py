"""Several blocks handed on as one, for a file that prefers few large pieces to many small ones."""

from __future__ import annotations

import numpy as np

from cube_sim.recording.batch import Block, LogLine, Rows, Sink, block_number


class GatheringSink:
    """Hands blocks on in pieces of so many simulated seconds.

    Pieces end where the time is a multiple of their length, however the blocks arrive.
    """

    def __init__(self, sink: Sink, seconds: int) -> None:
        self._sink = sink
        self._seconds = seconds
        self._piece: int | None = None
        self._rows: dict[str, list[Rows]] = {}
        self._log: list[LogLine] = []

    def write(self, block: Block) -> None:
        """Keep a block, and hand on the piece before it when it begins a new one."""
        piece = block_number(_start(block)) // self._seconds
        if piece != self._piece:
            self._hand_on()
            self._piece = piece
        for name, rows in block.rows.items():
            self._rows.setdefault(name, []).append(rows)
        self._log += block.log

    def close(self) -> None:
        """Hand on what is left and finish the sink."""
        try:
            self._hand_on()
        finally:
            self._sink.close()

    def _hand_on(self) -> None:
        if self._rows or self._log:
            rows = {name: np.concatenate(parts) for name, parts in self._rows.items()}
            block, self._rows, self._log = Block(rows, self._log), {}, []
            self._sink.write(block)


def _start(block: Block) -> float:
    """Find the earliest instant [s] of a block."""
    return min([rows[0, 0] for rows in block.rows.values()] + [line.t for line in block.log])
