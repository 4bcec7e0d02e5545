"""A run on its way to its files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

import mujoco

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch, Rows, Sink, View
from cube_sim.recording.beside import SinkBeside
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import vehicle_name
from cube_sim.recording.header import RunHeader
from cube_sim.recording.live import LiveSink
from cube_sim.recording.long_run import RecordedSignals
from cube_sim.recording.mcap.scene import SceneRows
from cube_sim.recording.mcap.sink import McapSink
from cube_sim.recording.run_end import RunEnd
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine

MCAP_NAME = "run.mcap"
RRD_NAME = "run.rrd"
REMEDY = "`cube-sim export --format rrd` makes it of the record"

MOST_KEPT_BYTES = 16_000_000
"""Five minutes of an eight-thruster vehicle at 50 Hz."""


class Recorder(SignalStore):
    """Records a run into a directory.

    Rows are copied into memory at once and go to the files when their simulated second is over: a killed process loses
    less than a simulated second, and what compiled code has flown while the one before was written.

    Rows are kept in memory too, for the checks, until they are `MOST_KEPT_BYTES`; from then on `signals` are read from
    the record.

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
    ) -> None:
        """Start the files.

        Args:
            directory: where they go; it exists.
            header: the inputs of the run.
            channels: the channel table.
            model: the compiled model, for what there is to draw.
            view: whether the Rerun view is written beside the record.
            vehicle: the body whose pose is recorded; None for the first that swims.
            live: port of this machine at which a viewer shows the run while it flies; None for no such viewer.
        """
        super().__init__(channels)
        self._closed, self._kept_bytes = False, 0
        self._recorded: RecordedSignals | None = None
        self.mcap = directory / MCAP_NAME
        self.rrd = directory / RRD_NAME
        name = vehicle or vehicle_name(model)
        scene = SceneRows(self._channels, model, vehicle, name)
        self._record = McapSink(self.mcap, header, self._channels, name, scene)
        self._shown = SinkBeside(lambda: self._view(header, model, vehicle)) if view else None
        self._live = None if live is None else LiveSink(lambda: self._streamed(live, header, model, vehicle))
        self._views: list[View] = [each for each in (self._live, self._shown) if each is not None]
        self._sinks: list[Sink] = [self._record, *self._views]

    def _view(self, header: RunHeader, model: mujoco.MjModel, vehicle: str | None) -> View:
        # What it cannot write is told once, by `warnings`; unasked, Rerun would tell it in its own words as well.
        os.environ.setdefault("RUST_LOG", "off")
        # Only a run that wants the view pays for its import.
        from cube_sim.recording.rerun.sink import rerun_sink

        return rerun_sink(self.rrd, header, self._channels, model, vehicle)

    def _streamed(self, port: int, header: RunHeader, model: mujoco.MjModel, vehicle: str | None) -> View:
        os.environ.setdefault("RUST_LOG", "off")  # a viewer that is not there is no news to Rerun alone
        from cube_sim.recording.rerun.sink import live_sink

        return live_sink(port, header, self._channels, model, vehicle)

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
                self._record.finish(end)
                for view in self._views:
                    view.tell(end)
            finally:
                self.close()

    def close(self) -> None:
        """Close the files; a record that was not finished does not say how its run ended."""
        try:
            self.settle()
        finally:
            views, self._views = self._views, []
            for view in views:
                view.close()
            self._record.close()
            if self._recorded is not None:
                self._recorded.finished()

    @property
    def warnings(self) -> tuple[LogLine, ...]:
        """What has been said at the level WARNING or above, and that the view cannot be written, if so.

        That stands in no record: it says nothing of the flight.
        """
        failure = "" if self._shown is None else self._shown.failure
        if not failure:
            return super().warnings
        line = LogLine(self.last_s, "WARNING", f"{RRD_NAME} cannot be written: {failure}; {REMEDY}")
        return (*super().warnings, line)

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
            self._written = {name: [] for name in self._written}

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
