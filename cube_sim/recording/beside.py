"""A sink that writes on a thread of its own while the flight goes on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from cube_sim.recording.batch import Batch, View
from cube_sim.recording.run_end import RunEnd

MOST_WAITING = 60
"""So many batches may wait to be written before whoever hands them on waits too: of five seconds each 15 megabytes."""


class SinkBeside:
    """Hands batches on in their order, one at a time. What goes wrong ends the sink, and nothing else.

    For views, which are made of the record again whenever they are wanted. The record itself waits for nobody: what
    is on its way to a thread is lost with the process.

    Attributes:
        failure: why the sink could not be written, in one line; "" while it could.
    """

    def __init__(self, make: Callable[[], View]) -> None:
        """Begin to make the sink, which may have much to load.

        Args:
            make: called once, on the thread.
        """
        self.failure = ""
        self._thread = ThreadPoolExecutor(1, "recording")
        self._made = self._thread.submit(make)
        self._writing: deque[Future[None]] = deque()

    def write(self, batch: Batch) -> None:
        """Hand a batch on; it is written when those before it are."""
        while self._writing and (self._writing[0].done() or len(self._writing) >= MOST_WAITING):
            self._await(self._writing.popleft())
        if not self.failure:
            self._writing.append(self._thread.submit(lambda: self._made.result().write(batch)))

    def tell(self, end: RunEnd) -> None:
        """Show how the run ended, once everything is written."""
        if not self.failure:
            self._writing.append(self._thread.submit(lambda: self._made.result().tell(end)))

    def close(self) -> None:
        """Finish the sink once everything is written."""
        while self._writing:
            self._await(self._writing.popleft())
        # A flight shorter than a piece of the view is written here; a failed one lets go of its file.
        self._await(self._thread.submit(lambda: self._made.result().close()))
        self._thread.shutdown()

    def _await(self, work: Future[None]) -> None:
        try:
            work.result()
        except Exception as error:  # what Rerun says of a full disk is a RuntimeError, of other things something else
            self.failure = self.failure or " ".join(str(error).split()) or type(error).__name__
