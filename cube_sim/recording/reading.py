"""Reading a recording back, bit for bit, also one whose writer was killed."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import descriptor_pool, message_factory
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.records import Channel as McapChannel
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows, signals
from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.header import RecordedCode, RunHeader
from cube_sim.recording.mcap.fixed_width import MESSAGE_HEADER, channel_layout
from cube_sim.recording.mcap.names import (
    ASSETS,
    CHANNEL_METADATA,
    CODE,
    CODE_METADATA,
    EPOCH_NS,
    LOG_TOPIC,
    MODEL,
    MODEL_NAME,
    RESOLVED,
    RUN_METADATA,
    SCENARIO,
    VERSIONS_METADATA,
)
from cube_sim.recording.mcap.reader import McapContents, chunks_of, places_of, read_contents
from cube_sim.recording.mcap.schemas import LOG, LOG_LEVELS, log_schema
from cube_sim.run_log import LogLine

_DECODED_AT_ONCE = 4096  # messages


@dataclass(frozen=True)
class Recording:
    """A run, read back.

    Attributes:
        header: the inputs of the run.
        vehicle: name of the vehicle's frame.
        channels: the channel table the run was recorded with.
        rows: all rows of each channel, (n, 1+width), column 0 the time [s].
        log: the messages, in the order of time.
        complete: False when the file ends before its index, as after a crash; all that is whole was read.
    """

    header: RunHeader
    vehicle: str
    channels: tuple[Channel, ...]
    rows: Mapping[str, Rows]
    log: tuple[LogLine, ...]
    complete: bool

    @property
    def signals(self) -> dict[str, Rows]:
        """Every field as "channel.field" -> (n, 1+width), column 0 the time [s]."""
        return signals(self.channels, self.rows)


def read_signals(path: str | Path) -> dict[str, Rows]:
    """Read the signals of a recording.

    Args:
        path: the MCAP file.

    Returns:
        "channel.field" -> (n, 1+width), column 0 the time [s]; the same bits the run had in memory.

    Raises:
        RecordingError: the file is not a recording, or it is damaged.
    """
    return read_recording(path).signals


def read_recording(path: str | Path) -> Recording:
    """Read a whole recording.

    Args:
        path: the MCAP file.

    Raises:
        RecordingError: the file is not a recording, or it is damaged. A file that merely ends early is read
            as far as it goes and marked incomplete.
    """
    path = Path(path)
    messages = _Messages(path)
    contents = read_contents(path, messages.take)
    try:
        header, vehicle = _header(contents)
    except KeyError as missing:
        raise RecordingError(f"{path} is no recording of cube_sim: it has no {missing}") from None
    columns = messages.columns.values()
    return Recording(
        header=header,
        vehicle=vehicle,
        channels=tuple(each.channel for each in columns),
        rows={each.channel.name: each.rows() for each in columns if each.some},
        log=tuple(messages.lines),
        complete=contents.complete,
    )


def read_channels(path: Path, names: Collection[str], chunks_at_once: int | None = None) -> Iterator[dict[str, Rows]]:
    """The rows of some channels; little more than these is ever in memory.

    Args:
        path: the MCAP file.
        names: of the channels.
        chunks_at_once: of so many chunks rows are handed on together; None for all.

    Yields:
        Channel -> (n, 1+width), column 0 the time [s], of those that have been declared so far.

    Raises:
        RecordingError: the file cannot be read, or it is damaged.
    """
    messages = _Messages(path, names)
    for number, chunk in enumerate(chunks_of(path)):
        if chunks_at_once is not None and number and number % chunks_at_once == 0:
            yield messages.rows()
        messages.take(chunk)
    yield messages.rows()


class _Columns:
    """The rows of one channel, as they come."""

    def __init__(self, path: Path, channel: Channel) -> None:
        self.channel, self.some = channel, False
        self._path, self._layout = path, channel_layout(channel)
        self._messages: list[NDArray[np.uint8]] = []
        self._rows: list[Rows] = []
        self._waiting = 0

    def take(self, messages: NDArray[np.uint8]) -> None:
        """Keep messages (n, L) that come next."""
        self.some = True
        if messages.shape[1] != self._layout.length:
            raise RecordingError(
                f"{self._path}: a message of channel {self.channel.name!r} has {messages.shape[1]} bytes, "
                f"not {self._layout.length}"
            )
        self._messages.append(messages)
        self._waiting += len(messages)
        if self._waiting >= _DECODED_AT_ONCE:
            self._decode()

    def rows(self) -> Rows:
        """Hand over those that have come, (n, 1+width), column 0 the time [s]."""
        self._decode()
        rows, self._rows = self._rows, []
        return np.concatenate(rows) if rows else np.empty((0, 1 + self.channel.width))

    def _decode(self) -> None:
        if self._messages:
            try:
                self._rows.append(self._layout.read(np.concatenate(self._messages), self.channel.width))
            except RecordingError as error:
                raise RecordingError(f"{self._path}: channel {self.channel.name!r}: {error}") from None
        self._messages, self._waiting = [], 0


class _Messages:
    """What the chunks of a recording hold.

    Attributes:
        columns: by the id of their channel.
        lines: of the log, in file order.
    """

    def __init__(self, path: Path, only: Collection[str] | None = None) -> None:
        """Begin.

        Args:
            path: of the file, for what is said of it.
            only: the channels that are wanted; None for all, and the log.
        """
        self.columns: dict[int, _Columns] = {}
        self.lines: list[LogLine] = []
        self._path, self._only = path, only
        self._logs: set[int] = set()

    def take(self, chunk: bytes) -> None:
        """Take the messages of the next chunk, uncompressed."""
        places = places_of(chunk)
        for declared in places.channels:
            if CHANNEL_METADATA in declared.metadata:
                channel = _channel(declared)
                if declared.id not in self.columns and (self._only is None or channel.name in self._only):
                    self.columns[declared.id] = _Columns(self._path, channel)
            elif declared.topic == LOG_TOPIC and self._only is None:
                self._logs.add(declared.id)
        bytes_of = np.frombuffer(chunk, np.uint8)
        lines: list[int] = []
        for (number, size), starts in places.messages.items():
            if number in self.columns:
                self.columns[number].take(_gathered(bytes_of, starts, size))
            elif number in self._logs:
                lines += starts
        self.lines += [_log_line(_body(chunk, start)) for start in sorted(lines)]

    def rows(self) -> dict[str, Rows]:
        """Hand over the rows that have come, (n, 1+width) of each channel."""
        return {each.channel.name: each.rows() for each in self.columns.values()}


def _gathered(chunk: NDArray[np.uint8], starts: list[int], size: int) -> NDArray[np.uint8]:
    """The messages (n, L) in records of equal size, by where these start."""
    windows = sliding_window_view(chunk, size - MESSAGE_HEADER.itemsize)
    return windows[np.array(starts) + MESSAGE_HEADER.itemsize]


def _body(chunk: bytes, start: int) -> bytes:
    """The message in the record that starts there."""
    length = int.from_bytes(chunk[start + 1 : start + 9], "little")
    return chunk[start + MESSAGE_HEADER.itemsize : start + 9 + length]


def _header(contents: McapContents) -> tuple[RunHeader, str]:
    run, files = contents.metadata[RUN_METADATA], contents.attachments
    header = RunHeader(
        scenario=files[SCENARIO].decode(),
        resolved=files[RESOLVED].decode(),
        model=run.get(MODEL_NAME, MODEL),
        inputs={name.removeprefix(ASSETS): data for name, data in files.items() if _is_input(name)},
        code=_code(contents),
        versions=contents.metadata[VERSIONS_METADATA],
        seed=int(run["seed"]),
    )
    return header, run["vehicle"]


def _is_input(name: str) -> bool:
    return name not in (SCENARIO, RESOLVED) and not name.startswith(CODE)


def _code(contents: McapContents) -> tuple[RecordedCode, ...]:
    """Code of the user's own that took part, by the values in whose place it stood."""
    named = [RecordedCode(key, name, "") for key, name in sorted(contents.metadata.get(CODE_METADATA, {}).items())]
    sources = [contents.attachments.get(CODE + code.file, b"").decode() for code in named]
    return tuple(replace(code, source=source) for code, source in zip(named, sources, strict=True))


def _channel(declared: McapChannel) -> Channel:
    table: dict[str, Any] = json.loads(declared.metadata[CHANNEL_METADATA])
    fields = tuple(
        Field(**{**field, "columns": tuple(field["columns"]), "labels": tuple(field["labels"])})
        for field in table["fields"]
    )
    return Channel(table["name"], fields, table["rate"])


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
