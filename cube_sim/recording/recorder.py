"""What the loop calls: one row per channel and tick, and nothing else to think about."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch, Rows, Sink, batch_number, signals
from cube_sim.recording.buffer import ChannelBuffer
from cube_sim.recording.channels import Channel
from cube_sim.recording.geometry import vehicle_name
from cube_sim.recording.header import RunHeader
from cube_sim.recording.mcap.schemas import LOG_LEVELS
from cube_sim.recording.mcap.sink import McapSink
from cube_sim.run_log import WEIGHTY, LogLine

MCAP_NAME = "run.mcap"
RRD_NAME = "run.rrd"


class Recorder:
    """Records a run into a directory.

    Rows are copied into memory at once and go to the files when their simulated second is over, so a killed
    process loses less than a simulated second.

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
        self._channels = tuple(channels)
        self._buffers = {channel.name: ChannelBuffer(channel) for channel in self._channels}
        self._written: dict[str, list[Rows]] = {channel.name: [] for channel in self._channels}
        self._log: list[LogLine] = []
        self._warnings: list[LogLine] = []
        self._time = -np.inf
        self._batch_end = -np.inf
        self._closed = False
        self.mcap = directory / MCAP_NAME
        self.rrd = directory / RRD_NAME
        self._sinks: list[Sink] = [McapSink(self.mcap, header, self._channels, vehicle or vehicle_name(model))]
        if view:
            # Only a run that wants the view pays for its import.
            from cube_sim.recording.rerun.sink import rerun_sink

            self._sinks.append(rerun_sink(self.rrd, header, self._channels, model, vehicle))

    def append(self, channel: str, t: float, *values: ArrayLike) -> None:
        """Record one row.

        Args:
            channel: its name in the channel table.
            t: simulated time [s]; never less than that of the row before it, in any channel.
            values: one per field in the order of the table: a float for one number without a name of its own, else
                an array (width,).

        Raises:
            RecordingError: no such channel, values that do not fit its fields, or time running backwards.
        """
        if t != self._time:
            self._advance(t)
        try:
            buffer = self._buffers[channel]
        except KeyError:
            raise RecordingError(f"no channel {channel!r}; there are {', '.join(self._buffers)}") from None
        buffer.append(t, values)

    def log(self, t: float, level: str, text: str) -> None:
        """Record a sentence.

        Args:
            t: simulated time [s].
            level: DEBUG, INFO, WARNING, ERROR or FATAL.
            text: the sentence.

        Raises:
            RecordingError: no such level, or time running backwards.
        """
        if level not in LOG_LEVELS:
            raise RecordingError(f"no log level {level!r}; there are {', '.join(LOG_LEVELS)}")
        if t != self._time:
            self._advance(t)
        line = LogLine(t, level, text)
        self._log.append(line)
        if level in WEIGHTY:
            self._warnings.append(line)

    @property
    def warnings(self) -> tuple[LogLine, ...]:
        """What has been said at the level WARNING or above, in the order of time."""
        return tuple(self._warnings)

    @property
    def signals(self) -> dict[str, Rows]:
        """Everything recorded: "channel.field" -> (n, 1+width), column 0 the time [s]."""
        rows = {name: np.concatenate([*self._written[name], buffer.rows]) for name, buffer in self._buffers.items()}
        return signals(self._channels, rows)

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

    def _advance(self, t: float) -> None:
        if self._closed:
            raise RecordingError(f"the recording {self.mcap} is closed; nothing can be added at t = {t} s")
        # Written this way round, a NaN is refused too.
        if not t >= self._time:
            raise RecordingError(f"time runs backwards: t = {t} s after t = {self._time} s")
        if t >= self._batch_end:
            self._flush()
            self._batch_end = batch_number(t) + 1
        self._time = t

    def _flush(self) -> None:
        rows = {name: buffer.take() for name, buffer in self._buffers.items()}
        batch = Batch({name: taken for name, taken in rows.items() if len(taken)}, self._log)
        if not batch.rows and not batch.log:
            return
        self._log = []
        for name, taken in batch.rows.items():
            self._written[name].append(taken)
        for sink in self._sinks:
            sink.write(batch)

    def __enter__(self) -> Recorder:
        """Use as a context manager."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Finish the files, whatever happened."""
        self.close()
