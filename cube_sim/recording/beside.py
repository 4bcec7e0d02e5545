"""A sink that writes on a thread of its own while the flight goes on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch, Sink

MOST_WAITING = 100
"""So many batches may wait to be written before whoever hands them on waits too: a few megabytes."""


class SinkBeside:
    """Hands batches on in their order, one at a time; what goes wrong is raised at the next call after it.

    For views, which are made of the record again whenever they are wanted. The record itself waits for nobody: what
    is on its way to a thread is lost with the process.
    """

    def __init__(self, make: Callable[[], Sink]) -> None:
        """Begin to make the sink, which may have much to load.

        Args:
            make: called once, on the thread.
        """
        self._thread = ThreadPoolExecutor(1, "recording")
        self._made = self._thread.submit(make)
        self._writing: deque[Future[None]] = deque()

    def write(self, batch: Batch) -> None:
        """Hand a batch on; it is written when those before it are."""
        while self._writing and (self._writing[0].done() or len(self._writing) >= MOST_WAITING):
            self._wait()
        self._writing.append(self._thread.submit(lambda: self._made.result().write(batch)))

    def close(self) -> None:
        """Finish the sink once everything is written."""
        try:
            while self._writing:
                self._wait()
        finally:
            self._thread.shutdown()
            with _as_recording_error():  # a flight shorter than a piece of the view is written here
                self._made.result().close()

    def _wait(self) -> None:
        """Wait for the batch that was handed on first."""
        with _as_recording_error():
            self._writing.popleft().result()


@contextmanager
def _as_recording_error() -> Iterator[None]:
    try:
        yield
    except RuntimeError as error:  # what Rerun says of a full disk
        raise RecordingError(f"the view cannot be written: {error}") from error
