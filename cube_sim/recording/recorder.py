"""A run on its way to its files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

import mujoco

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch, Rows, Sink
from cube_sim.recording.beside import SinkBeside
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import vehicle_name
from cube_sim.recording.header import RunHeader
from cube_sim.recording.long_run import RecordedSignals
from cube_sim.recording.mcap.sink import McapSink
from cube_sim.recording.signal_store import SignalStore

MCAP_NAME = "run.mcap"
RRD_NAME = "run.rrd"


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
    ) -> None:
        """Start the files.

        Args:
            directory: where they go; it exists.
            header: the inputs of the run.
            channels: the channel table.
            model: the compiled model, for what there is to draw.
            view: whether the Rerun view is written beside the record.
            vehicle: the body whose pose is recorded; None for the first that swims.
        """
        super().__init__(channels)
        self._closed, self._kept_bytes = False, 0
        self.mcap = directory / MCAP_NAME
        self.rrd = directory / RRD_NAME
        self._sinks: list[Sink] = [McapSink(self.mcap, header, self._channels, vehicle or vehicle_name(model))]
        if view:
            self._sinks.append(SinkBeside(lambda: self._view(header, model, vehicle)))

    def _view(self, header: RunHeader, model: mujoco.MjModel, vehicle: str | None) -> Sink:
        # Only a run that wants the view pays for its import.
        from cube_sim.recording.rerun.sink import rerun_sink

        return rerun_sink(self.rrd, header, self._channels, model, vehicle)

    def close(self) -> None:
        """Send the last rows to the files and finish them."""
        if self._closed:
            return
        self._closed = True
        try:
            self._flush()
        finally:
            for sink in self._sinks:
                sink.close()

    @property
    def signals(self) -> Mapping[str, Rows]:
        """Everything recorded: "channel.field" -> (n, 1+width), column 0 the time [s].

        Raises:
            RecordingError: they have to be read from the record, and it is not closed.
        """
        if self._kept_bytes <= MOST_KEPT_BYTES:
            return super().signals
        if not self._closed:
            raise RecordingError(f"the recording {self.mcap} is too long to be kept in memory: close it first")
        return RecordedSignals(self.mcap, self._channels)

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
        """Finish the files, whatever happened."""
        self.close()
