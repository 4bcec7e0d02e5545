"""The rows and sentences of a run, in memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import RecordingError
from cube_sim.nearest import among
from cube_sim.recording.batch import Batch, BySignal, Rows, Sink, batch_number, signals, ticks_left_of_second
from cube_sim.recording.buffer import ChannelBuffer
from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.schemas import LOG_LEVELS
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import WEIGHTY, LogLine
from cube_sim.uninterrupted import uninterrupted

TICKS_IN_MEMORY = 500
"""Of so many ticks rows may be handed over at once where no file waits for each second."""


class SignalStore:
    """What the loop calls: one row per channel and tick.

    Rows are copied at once, and handed to sinks, where there are any, when their simulated second is over.

    Args:
        channels: the channel table.
    """

    def __init__(self, channels: Sequence[Channel]) -> None:
        self._channels = tuple(channels)
        self._sinks: list[Sink] = []
        self.clear()

    def clear(self) -> None:
        """Forget everything; time may start again."""
        self._buffers = {channel.name: ChannelBuffer(channel) for channel in self._channels}
        self._written: dict[str, list[Rows]] = {channel.name: [] for channel in self._channels}
        self._log: list[LogLine] = []
        self._lines: list[LogLine] = []
        self._waits = False
        self._time = -np.inf
        self._batch_end = -np.inf

    def take_up(self, other: SignalStore) -> None:
        """Have recorded what another one has, of the same channels; neither changes what the other has afterwards."""
        self.clear()
        for name, buffer in other._buffers.items():
            self._buffers[name].extend(buffer.rows)
        self._written = {name: list(rows) for name, rows in other._written.items()}
        self._log, self._lines = list(other._log), list(other._lines)
        self._waits, self._time, self._batch_end = other._waits, other._time, other._batch_end

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
        self._buffer(channel).append(t, values)
        self._waits = True

    @property
    def writes(self) -> bool:
        """Whether each second's rows are waited for by a file."""
        return bool(self._sinks)

    def ticks_at_once(self, tick: int, period: float) -> int:
        """Of how many ticks, from this one on, rows may be handed over at once.

        Args:
            tick: its number.
            period: of the ticks [s].
        """
        return ticks_left_of_second(tick, period) if self._sinks else TICKS_IN_MEMORY

    def hand_on(self) -> None:
        """Let the files have what is recorded: its second is over, though no row of the next has come yet."""
        if self._sinks:
            self._flush()

    def extend(self, first: float, last: float, rows: Iterable[tuple[str, Rows]], ours: bool = False) -> None:
        """Record rows of `ticks_at_once`.

        Args:
            first: the earliest time in them [s]; never in a second before that of what is recorded already.
            last: the latest time in them [s].
            rows: (n, 1+width) of each channel by name, column 0 the time.
            ours: whether nobody else writes into them any more, so that they need not be copied.

        Raises:
            RecordingError: no such channel, rows that do not fit it, or time running backwards.
        """
        if first > self._time:
            self._advance(first)
        if not first <= last or (self._sinks and {batch_number(first), batch_number(last)} != {self._batch_end - 1}):
            raise RecordingError(f"rows from t = {first} s to {last} s after t = {self._time} s")
        with uninterrupted():  # all channels or none
            for channel, table in rows:
                self._buffer(channel).extend(table, ours)
            self._waits = True
            self._time = max(self._time, last)

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
        line = LogLine(round(t, 9), level, text)  # a time that is a whole number of ticks may be off by rounding
        self._log.append(line)
        self._waits = True
        self._lines.append(line)

    def hurry(self) -> None:
        """See `Recorder.hurry`: here nobody is waited for."""

    def settle(self) -> None:
        """Nothing comes any more."""

    def finish(self, end: RunEnd) -> None:
        """See `Recorder.finish`: here nobody keeps it."""

    @property
    def last_s(self) -> float:
        """Time of the last row or sentence [s]; 0 before the first."""
        return max(self._time, 0.0)

    @property
    def lines(self) -> tuple[LogLine, ...]:
        """What has been said, in the order of time."""
        return tuple(self._lines)

    @property
    def warnings(self) -> tuple[LogLine, ...]:
        """What has been said at the level WARNING or above, in the order of time."""
        return tuple(line for line in self._lines if line.level in WEIGHTY)

    @property
    def signals(self) -> Mapping[str, Rows]:
        """Everything recorded: "channel.field" -> (n, 1+width), column 0 the time [s]."""
        named = BySignal[Rows]()
        for channel in self._channels:  # one after another: all rows of all channels are in memory twice, not thrice
            rows = np.concatenate([*self._written[channel.name], self._buffers[channel.name].rows])
            named |= signals((channel,), {channel.name: rows})
        return named

    def _buffer(self, channel: str) -> ChannelBuffer:
        try:
            return self._buffers[channel]
        except KeyError:
            raise RecordingError(f"no channel {channel!r}; there are {among(channel, self._buffers)}") from None

    def _advance(self, t: float) -> None:
        # Written this way round, a NaN is refused too.
        if not t >= self._time:
            raise RecordingError(f"time runs backwards: t = {t} s after t = {self._time} s")
        if t >= self._batch_end:
            self._flush()
            self._batch_end = batch_number(t) + 1
        self._time = t

    def _keep(self, batch: Batch) -> None:
        for name, taken in batch.rows.items():
            self._written[name].append(taken)

    def _flush(self) -> None:
        if self._waits:
            with uninterrupted(start_up=True):  # with its first second a run begins to be recorded
                self._to_sinks()

    def _to_sinks(self) -> None:
        batch = Batch({name: buffer.take() for name, buffer in self._buffers.items() if len(buffer)}, self._log)
        self._log, self._waits = [], False
        self._keep(batch)
        for sink in self._sinks:
            sink.write(batch)
