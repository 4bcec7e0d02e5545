"""The files of a run, opened when there is something to put into them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from cube_sim.recording.batch import Batch, View
from cube_sim.recording.mcap.sink import McapSink
from cube_sim.recording.run_end import RunEnd
from cube_sim.whole_file import part_of


class RunFiles:
    """A sink that opens the record and its views with the first second it gets, and not before.

    What goes wrong while a run starts up leaves the place as it was, and nothing is written from then on: the record is
    begun beside it, and put there once its first second is written.

    Args:
        mcap: path of the record.
        record: begins it at a path.
        views: begins them.
        begin: called before the record takes its place.
    """

    def __init__(
        self,
        mcap: Path,
        record: Callable[[Path], McapSink],
        views: Callable[[], Sequence[View]],
        begin: Callable[[], None],
    ) -> None:
        self._mcap, self._make_record, self._make_views, self._begin = mcap, record, views, begin
        self._record: McapSink | None = None
        self._views: Sequence[View] = ()
        self._closed = False

    def write(self, batch: Batch) -> None:
        """Take the next batch.

        Raises:
            OSError: there is no room for it. Where it is the first, the place is as it was.
        """
        if self._record is None:
            self._open(lambda record: record.write(batch))
        else:
            self._record.write(batch)
        for view in self._views:
            view.write(batch)

    def finish(self, end: RunEnd) -> None:
        """Write how the run ended, and show it; once the files are closed nothing is written.

        Raises:
            OSError: there is no room for it.
        """
        if self._closed:
            return
        if self._record is None:
            self._open(lambda record: record.finish(end))
        else:
            self._record.finish(end)
        for view in self._views:
            view.tell(end)

    def close(self) -> None:
        """Close what has been opened, the record first: views may have to be waited for. Once is enough."""
        self._closed = True
        views, self._views = self._views, ()
        try:
            if self._record is not None:
                self._record.close()
        finally:
            for view in views:
                view.close()

    def _open(self, write_first: Callable[[McapSink], None]) -> None:
        part = part_of(self._mcap)
        try:
            record = self._make_record(part)
            write_first(record)
            self._begin()
            record.move_to(self._mcap)
        except BaseException:
            self._closed = True
            part.unlink(missing_ok=True)
            raise
        self._record, self._views = record, self._make_views()
