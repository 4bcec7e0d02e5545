"""A run on its way to its files."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Thread
from types import TracebackType

import mujoco

from cube_sim.errors import RecordingError
from cube_sim.recording.among import VehicleAmong
from cube_sim.recording.batch import Batch, Rows, Sink, View
from cube_sim.recording.beside import SinkBeside
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import vehicle_name
from cube_sim.recording.header import RunHeader
from cube_sim.recording.live import LiveSink
from cube_sim.recording.long_run import RecordedSignals
from cube_sim.recording.mcap.fleet_scene import FleetSceneRows
from cube_sim.recording.mcap.scene import SceneRows
from cube_sim.recording.mcap.sink import McapSink
from cube_sim.recording.rerun.apart import is_begun, view_apart
from cube_sim.recording.rerun.gathering import GatheringSink
from cube_sim.recording.rerun.patience import Patience
from cube_sim.recording.run_end import RunEnd
from cube_sim.recording.run_files import RunFiles
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine

MCAP_NAME = "run.mcap"
RRD_NAME = "run.rrd"
_VIEWS = "cube_sim.recording.rerun.sink"
REMEDY = "the record is whole without it, and `cube-sim export --format rrd` makes it anew of that, if it can"

HANDED_ON_S = 5
"""So many simulated seconds at a time go to the view, which is written in larger pieces still: each costs a change of
threads and a message to another process."""

MOST_KEPT_BYTES = 16_000_000
"""Five minutes of an eight-thruster vehicle at 50 Hz."""


class Recorder(SignalStore):
    """Records a run into a directory.

    Rows are copied into memory at once and go to the files when their simulated second is over: a killed process loses
    less than a simulated second, and what compiled code has flown while the one before was written. The files are
    opened for the first of them: until then an earlier run in the directory stays as it is.

    Rows are kept in memory too, for whoever asks for `signals`, until they are `MOST_KEPT_BYTES`; from then on they
    are read from the record.

    Attributes:
        mcap: path of the record.
        rrd: path of its Rerun view.
    """

    def __init__(
        self,
        directory: Path,
        header: RunHeader,
        channels: Sequence[Channel],
        model: mujoco.MjModel,
        view: bool = True,
        vehicle: str | None = None,
        live: int | None = None,
        begin: Callable[[], None] = lambda: None,
        also: Sink | None = None,
        among: Sequence[VehicleAmong] = (),
    ) -> None:
        """Write nothing yet.

        Args:
            directory: where the files go; it exists.
            header: the inputs of the run.
            channels: the channel table.
            model: the compiled model, for what there is to draw.
            view: whether the Rerun view is written beside the record.
            vehicle: the body whose pose is recorded; None for the first that swims.
            live: port of this machine at which a viewer shows the run while it flies; None for no such viewer.
            begin: called when the files are to be opened, before a record that is there is replaced.
            also: who looks at the batches once they are in the record.
            among: of several vehicles, each; none of one.
        """
        super().__init__(channels)
        self._closed, self._kept_bytes = False, 0
        self._recorded: RecordedSignals | None = None
        self.mcap = directory / MCAP_NAME
        self.rrd = directory / RRD_NAME
        self._shown: SinkBeside | None = None
        self._patience = Patience()
        name = ", ".join(each.name for each in among) or vehicle or vehicle_name(model)
        alone = SceneRows(self._channels, model, vehicle, name) if not among else None
        scene = alone or FleetSceneRows(self._channels, among)
        self._among = tuple(among)
        self._not_drawn = scene.not_drawn
        if view or live is not None:
            # What a view cannot do is told once, by `warnings`; unasked, Rerun would tell it in its own words as well.
            os.environ.setdefault("RUST_LOG", "off")
            # Only a run that wants a view pays for its import, while it starts up.
            if live is not None or not is_begun():
                Thread(target=_load_views, name="view").start()

        def record(place: Path) -> McapSink:
            return McapSink(place, header, self._channels, name, scene)

        def views() -> list[View]:
            found: list[View] = []
            if (port := live) is not None:
                found.append(LiveSink(lambda: self._streamed(port, header, model, vehicle)))
            if view:
                self._shown = SinkBeside(lambda: self._view(header, model, vehicle))
                found.append(GatheringSink(self._shown, HANDED_ON_S))
            return found

        self._files = RunFiles(self.mcap, record, views, begin)
        self._sinks += [self._files, *([] if also is None else [also])]

    def _view(self, header: RunHeader, model: mujoco.MjModel, vehicle: str | None) -> View:
        if is_begun():
            view = self._view_apart(header, model, vehicle)
            if view is not None:
                return view
        from cube_sim.recording.rerun.sink import rerun_sink

        return rerun_sink(self.rrd, header, self._channels, model, vehicle, among=self._among)

    def _view_apart(self, header: RunHeader, model: mujoco.MjModel, vehicle: str | None) -> View | None:
        from cube_sim.recording.rerun.telling import stories_of, story_of

        told = stories_of(header) if self._among else story_of(header)
        return view_apart(self._patience, self.rrd, header, self._channels, model, vehicle, told, self._among)

    def _streamed(self, port: int, header: RunHeader, model: mujoco.MjModel, vehicle: str | None) -> View:
        from cube_sim.recording.rerun.sink import live_sink

        return live_sink(port, header, self._channels, model, vehicle, self._among)

    def hurry(self) -> None:
        """Wait for the view only for some seconds from now on: somebody wants the run to end."""
        self._patience.hurried = True

    def settle(self) -> None:
        """Send the last rows to the files: nothing can be added from now on."""
        if not self._closed:
            self._closed = True
            self._flush()

    def finish(self, end: RunEnd) -> None:
        """Write how the run ended, show it, and close the files; once is enough.

        Raises:
            OSError: there is no room for it; all that is in the record already stays readable.
        """
        try:
            self.settle()
        finally:
            try:
                self._files.finish(end)
            finally:
                self.close()

    def close(self) -> None:
        """Close the files; a record that was not finished does not say how its run ended."""
        try:
            self.settle()
        finally:
            self._files.close()
            self._remove_a_failed_view()
            if self._recorded is not None:
                self._recorded.finished()

    def _remove_a_failed_view(self) -> None:
        """Leave no part of a view: who opens it would take it for the run."""
        if self._shown is not None and self._shown.failure:
            with suppress(OSError):
                if self.rrd.is_file():
                    self.rrd.unlink()

    @property
    def warnings(self) -> tuple[LogLine, ...]:
        """What has been said at the level WARNING or above, and what cannot be shown, if anything.

        That stands in no record: it says nothing of the flight.
        """
        said = [f"{MCAP_NAME} lets viewers draw less: {each}" for each in self._not_drawn]
        if self._shown is not None and self._shown.failure:
            said.append(f"{RRD_NAME} cannot be written: {self._shown.failure}; {REMEDY}")
        return (*super().warnings, *(LogLine(self.last_s, "WARNING", each) for each in said))

    @property
    def signals(self) -> Mapping[str, Rows]:
        """Everything recorded: "channel.field" -> (n, 1+width), column 0 the time [s].

        Raises:
            RecordingError: they have to be read from the record, and it is not settled.
        """
        if self._kept_bytes <= MOST_KEPT_BYTES:
            return super().signals
        if not self._closed:
            raise RecordingError(f"the recording {self.mcap} is too long to be kept in memory: settle it first")
        if self._recorded is None:
            self._recorded = RecordedSignals(self.mcap, self._channels)
        return self._recorded

    def _keep(self, batch: Batch) -> None:
        self._kept_bytes += sum(rows.nbytes for rows in batch.rows.values())
        if self._kept_bytes <= MOST_KEPT_BYTES:
            super()._keep(batch)
        else:
            for kept in self._written.values():
                kept.clear()

    def _advance(self, t: float) -> None:
        if self._closed:
            raise RecordingError(f"the recording {self.mcap} is closed; nothing can be added at t = {t} s")
        super()._advance(t)

    def __enter__(self) -> Recorder:
        """Use as a context manager."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the files, whatever happened."""
        self.close()


def _load_views() -> None:
    with suppress(Exception):  # told by the view that needs it
        import_module(_VIEWS)
