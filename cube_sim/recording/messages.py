"""The messages of a record as rows of its channels and lines of its log, in whatever order the file has them."""

from __future__ import annotations

import json
from collections.abc import Collection
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import descriptor_pool, message_factory
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.records import Channel as McapChannel
from numpy.typing import NDArray

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.mcap.fixed_width import MESSAGE_HEADER, Layout, channel_layout, packed_layout
from cube_sim.recording.mcap.names import CHANNEL_METADATA, EARLIER, EPOCH_NS, LOG_TOPIC
from cube_sim.recording.mcap.passing import NotInOrderError
from cube_sim.recording.mcap.reader import places_of
from cube_sim.recording.mcap.schemas import LOG, LOG_LEVELS, log_schema
from cube_sim.run_log import LogLine

_DECODED_AT_ONCE = 4096  # messages
_MOST_KEPT = 64
"""So many channels are kept: a damaged record declares them again with each piece that is tried."""


class RecordedMessages:
    """What the chunks of a recording hold.

    Attributes:
        channels: by name, in the order in which they are declared.
    """

    def __init__(self, path: Path, format_: str, only: Collection[str] | None = None) -> None:
        """Begin.

        Args:
            path: of the file, for what is said of it.
            format_: of the recording.
            only: the channels that are wanted; None for all, and the log.
        """
        self.channels: dict[str, Channel] = {}
        self._path, self._only = path, only
        self._layout_of = packed_layout if format_ in EARLIER else channel_layout
        self._columns: dict[str, _Columns] = {}
        self._of: dict[int, _Columns] = {}  # by the id that a file gives to a channel
        self._logs: set[int] = set()
        self._lines: list[tuple[int, LogLine]] = []

    def take(self, chunk: bytes) -> None:
        """Take the messages of the next chunk, uncompressed.

        Raises:
            RecordingError: it is damaged, or of two runs.
        """
        places = places_of(self._path, chunk)
        for declared in places.channels:
            self.declare(declared)
        lines: list[int] = []
        for (number, size), starts in places.messages.items():
            if number in self._of:
                windows = np.ndarray((len(chunk) - size + 1, size), np.uint8, chunk, 0, (1, 1))
                self._of[number].take(windows[np.array(starts)])
            elif number in self._logs:
                lines += starts
        self._lines += [self._line(chunk, start) for start in sorted(lines)]

    def declare(self, declared: McapChannel) -> None:
        """Take in what a channel is.

        Raises:
            RecordingError: it makes no sense, or there is another of its name.
        """
        if CHANNEL_METADATA in declared.metadata:
            try:
                channel = _channel(declared.metadata[CHANNEL_METADATA])
            except (ValueError, TypeError, KeyError) as error:
                raise RecordingError(f"{self._path} is damaged: what {declared.topic} holds cannot be read") from error
            if self._only is not None and channel.name not in self._only:
                return
            if self.channels.setdefault(channel.name, channel) != channel:
                raise RecordingError(f"{self._path} holds two runs: there are two channels {channel.name!r}")
            self._of[declared.id] = self._columns_of(channel)
        elif declared.topic == LOG_TOPIC and self._only is None:
            self._logs.add(declared.id)

    def _columns_of(self, channel: Channel) -> _Columns:
        if channel.name not in self._columns:
            self._columns[channel.name] = _Columns(self._path, channel, self._layout_of(channel))
        return self._columns[channel.name]

    def rows(self) -> dict[str, Rows]:
        """Hand over the rows that have come, (n, 1+width) of each channel.

        Raises:
            RecordingError: one is there twice.
        """
        return {name: columns.rows() for name, columns in self._columns.items()}

    def following_rows(self) -> dict[str, Rows]:
        """The same for who asks again and again.

        Raises:
            NotInOrderError: they do not follow, in the order of their writing, on those handed over before.
        """
        return {name: columns.following_rows() for name, columns in self._columns.items()}

    def lines(self) -> tuple[LogLine, ...]:
        """Of the log, in the order in which they were said.

        Raises:
            RecordingError: one is there twice.
        """
        numbers = np.array([number for number, _ in self._lines], np.int64)
        times = np.array([line.t for _, line in self._lines])
        order = _order(self._path, "log", numbers, times, of_a_clock=False)
        return tuple(self._lines[k][1] for k in order)

    def _line(self, chunk: bytes, start: int) -> tuple[int, LogLine]:
        """The number of a line, and the line, in the record that starts there."""
        length = int.from_bytes(chunk[start + 1 : start + 9], "little")
        head = np.frombuffer(chunk, MESSAGE_HEADER, 1, start)
        try:
            return int(head["sequence"][0]), _log_line(chunk[start + MESSAGE_HEADER.itemsize : start + 9 + length])
        except Exception as error:  # the library has no one exception for what is no message
            raise RecordingError(f"{self._path} is damaged: a line of the log cannot be read") from error


class _Columns:
    """The rows of one channel, as they come."""

    def __init__(self, path: Path, channel: Channel, layout: Layout) -> None:
        self._path, self._channel, self._layout = path, channel, layout
        self._records: list[NDArray[np.uint8]] = []
        self._rows: list[Rows] = []
        self._numbers: list[NDArray[np.uint32]] = []
        self._waiting, self._last_number = 0, -1

    def take(self, records: NDArray[np.uint8]) -> None:
        """Keep message records (n, size) that come next."""
        found = records.shape[1] - MESSAGE_HEADER.itemsize
        if found != self._layout.length:
            raise RecordingError(
                f"{self._path} is damaged: a message of channel {self._channel.name!r} has {found} bytes, "
                f"not {self._layout.length}"
            )
        self._records.append(records)
        self._waiting += len(records)
        if self._waiting >= _DECODED_AT_ONCE:
            self._decode()

    def rows(self) -> Rows:
        """Hand over those that have come, (n, 1+width), column 0 the time [s], in the order of their writing."""
        rows, numbers = self._as_they_came()
        order = _order(self._path, self._channel.name, numbers, rows[:, 0], of_a_clock=self._channel.rate > 0)
        return rows if isinstance(order, range) else rows[order]

    def following_rows(self) -> Rows:
        """The same; a `NotInOrderError` unless they follow on those handed over before."""
        rows, numbers = self._as_they_came()
        if len(numbers):
            if numbers[0] <= self._last_number or np.any(numbers[1:] <= numbers[:-1]):
                raise NotInOrderError(f"{self._path} has rows of {self._channel.name!r} in another order")
            self._last_number = int(numbers[-1])
        return rows

    def _as_they_came(self) -> tuple[Rows, NDArray[np.uint32]]:
        """Hand over rows and their sequence numbers (n,)."""
        self._decode()
        if not self._rows:
            return np.empty((0, 1 + self._channel.width)), np.empty(0, np.uint32)
        rows, numbers = np.concatenate(self._rows), np.concatenate(self._numbers)
        self._rows, self._numbers = [], []
        return rows, numbers

    def _decode(self) -> None:
        if self._records:
            records = np.concatenate(self._records)
            heads = np.ascontiguousarray(records[:, : MESSAGE_HEADER.itemsize]).view(MESSAGE_HEADER)
            try:
                rows = self._layout.read(records[:, MESSAGE_HEADER.itemsize :], self._channel.width)
            except RecordingError as error:
                raise RecordingError(f"{self._path} is damaged: channel {self._channel.name!r}: {error}") from None
            self._rows.append(rows)
            self._numbers.append(heads["sequence"].ravel())
        self._records, self._waiting = [], 0


def _order(
    path: Path, what: str, numbers: NDArray[np.integer[Any]], times: NDArray[np.float64], of_a_clock: bool
) -> range | NDArray[np.intp]:
    """In which order rows were written.

    Args:
        path: of the file.
        what: they are rows of.
        numbers: (n,) their sequence numbers; all 0 where another program did not keep them.
        times: (n,) [s].
        of_a_clock: whether no two have the same time.

    Raises:
        RecordingError: one is there twice.
    """
    n = len(numbers)
    if n < 2 or np.all(numbers[1:] > numbers[:-1]):
        return range(n)
    kept = bool(numbers.any())
    keys = numbers if kept else times
    order = np.argsort(keys, kind="stable")
    if (kept or of_a_clock) and np.any(keys[order][1:] == keys[order][:-1]):
        raise RecordingError(f"{path} holds two runs, or one twice: rows of {what!r} are there twice")
    return order


@lru_cache(_MOST_KEPT)
def _channel(text: str) -> Channel:
    table: dict[str, Any] = json.loads(text)
    fields = tuple(
        Field(**{**field, "columns": tuple(field["columns"]), "labels": tuple(field["labels"])})
        for field in table["fields"]
    )
    channel = Channel(table["name"], fields, table["rate"])
    hash(channel)  # a TypeError where lists stand in place of texts
    return channel


@cache
def _log_class() -> Any:
    pool = descriptor_pool.DescriptorPool()
    for file in FileDescriptorSet.FromString(log_schema()).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(LOG))


def _log_line(message: bytes) -> LogLine:
    log = _log_class().FromString(message)
    elapsed_ns = log.timestamp.seconds * 1_000_000_000 + log.timestamp.nanos - EPOCH_NS
    return LogLine(elapsed_ns / 1e9, LOG_LEVELS[log.level], log.message)
