"""A run shown while it flies, by a viewer that may lag, be absent or die: none of that changes the run."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import suppress
from queue import Full, Queue
from threading import Thread

from cube_sim.recording.batch import Batch, View
from cube_sim.recording.run_end import RunEnd

VIEWER_PORT = 9876
"""Where the Rerun viewer listens unless it is told otherwise."""

MOST_WAITING = 60
"""So many simulated seconds may wait for a viewer that lags; what comes after them is left out."""

PATIENCE_S = 3.0
"""So long a finished run waits for what is still on its way to the viewer."""


class LiveSink:
    """Hands batches on, and waits for nobody.

    Attributes:
        left_out: how many batches the viewer was too slow for, or did not live to see.
    """

    def __init__(self, make: Callable[[], View]) -> None:
        """Begin to make the sink that shows them.

        Args:
            make: called once, on a thread of its own.
        """
        self.left_out = 0
        self._waiting: Queue[Batch | RunEnd | None] = Queue(MOST_WAITING)
        self._thread = Thread(target=self._show, args=(make,), name="live view", daemon=True)
        self._thread.start()

    def write(self, batch: Batch) -> None:
        """Hand a batch on, if there is room for it."""
        try:
            self._waiting.put_nowait(batch)
        except Full:
            self.left_out += 1

    def tell(self, end: RunEnd) -> None:
        """Hand on how the run ended, waiting a little for room."""
        with suppress(Full):
            self._waiting.put(end, timeout=PATIENCE_S)

    def close(self) -> None:
        """Wait a little for what is on its way; what takes longer is not shown."""
        try:
            self._waiting.put(None, timeout=PATIENCE_S)
        except Full:
            return
        self._thread.join(PATIENCE_S)

    def _show(self, make: Callable[[], View]) -> None:
        shown: View | None = None
        try:
            shown = make()
            while (each := self._waiting.get()) is not None:
                if isinstance(each, RunEnd):
                    shown.tell(each)
                else:
                    shown.write(each)
            shown.close()
        except Exception:  # whatever a viewer does, the run goes on without it
            while self._waiting.get() is not None:
                self.left_out += 1


def somebody_listens(port: int) -> bool:
    """Whether there is a viewer at a port of this machine."""
    with socket.socket() as probe:
        probe.settimeout(1.0)
        return probe.connect_ex(("127.0.0.1", port)) == 0
