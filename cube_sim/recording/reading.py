"""Reading a recording back, bit for bit, also one whose writer was killed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf import descriptor_pool, message_factory
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.opcode import Opcode
from mcap.records import Channel as McapChannel
from numpy.typing import NDArray

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows, signals
from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.header import RecordedCode, RunHeader
from cube_sim.recording.mcap.fixed_width import Layout, channel_layout
from cube_sim.recording.mcap.reader import McapContents, chunks_of, read_channels, read_contents
from cube_sim.recording.mcap.schemas import LOG, LOG_LEVELS, log_schema
from cube_sim.recording.mcap.sink import (
    ASSETS,
    CHANNEL_METADATA,
    CODE,
    CODE_METADATA,
    EPOCH_NS,
    LOG_TOPIC,
    MODEL,
    RESOLVED,
    RUN_METADATA,
    SCENARIO,
    VERSIONS_METADATA,
)
from cube_sim.recording.mcap.writer import MESSAGE_HEADER
from cube_sim.run_log import LogLine

_SAME = 11  # bytes of opcode, length and channel id: messages alike in these can be read as one array


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
    contents = read_contents(path)
    try:
        header, vehicle = _header(contents)
    except KeyError as missing:
        raise RecordingError(f"{path} is no recording of cube_sim: it has no {missing}") from None
    channels = {c.id: _channel(c) for c in contents.channels.values() if CHANNEL_METADATA in c.metadata}
    logs = {c.id for c in contents.channels.values() if c.topic == LOG_TOPIC}
    rows: dict[int, list[Rows]] = {number: [] for number in channels}
    lines: list[LogLine] = []
    layouts = {number: channel_layout(channel) for number, channel in channels.items()}
    for chunk in contents.chunks:
        for number, messages in _message_runs(chunk):
            if number in layouts:
                rows[number].append(_decode(path, channels[number], layouts[number], messages))
            elif number in logs:
                lines += [_log_line(message) for message in messages]
    return Recording(
        header=header,
        vehicle=vehicle,
        channels=tuple(channels.values()),
        rows={channels[number].name: np.concatenate(parts) for number, parts in rows.items() if parts},
        log=tuple(lines),
        complete=contents.complete,
    )


def read_channel(path: Path, channel: Channel) -> Rows:
    """The rows of one channel, (n, 1+width), column 0 the time [s]; little more than these is ever in memory.

    Args:
        path: the MCAP file.
        channel: as it was recorded.

    Raises:
        RecordingError: the file cannot be read, or it is damaged.
    """
    layout, parts = channel_layout(channel), [np.empty((0, 1 + channel.width))]
    numbers: set[int] = set()
    for chunk in chunks_of(path):
        declared: dict[int, McapChannel] = {}
        read_channels(chunk, declared)
        ours = (c for c in declared.values() if CHANNEL_METADATA in c.metadata)
        numbers |= {c.id for c in ours if _channel(c).name == channel.name}
        runs = (messages for number, messages in _message_runs(chunk) if number in numbers)
        parts += [_decode(path, channel, layout, messages) for messages in runs]
    return np.concatenate(parts)


def _header(contents: McapContents) -> tuple[RunHeader, str]:
    run, files = contents.metadata[RUN_METADATA], contents.attachments
    header = RunHeader(
        scenario=files[SCENARIO].decode(),
        resolved=files[RESOLVED].decode(),
        mjcf=files[MODEL].decode(),
        assets={name.removeprefix(ASSETS): data for name, data in files.items() if name.startswith(ASSETS)},
        code=_code(contents),
        versions=contents.metadata[VERSIONS_METADATA],
        seed=int(run["seed"]),
    )
    return header, run["vehicle"]


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


def _message_runs(chunk: bytes) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Find the messages of a chunk.

    The next record with the same channel and length is one record further on as long as the headers agree,
    so a batch that was written as one array is read as one. Interleaved channels are runs of length one.

    Args:
        chunk: uncompressed records.

    Yields:
        The channel, and its consecutive messages of equal length as (n, L) bytes.
    """
    data, position = np.frombuffer(chunk, np.uint8), 0
    while position < len(data):
        size = 9 + int.from_bytes(chunk[position + 1 : position + 9], "little")
        if data[position] != Opcode.MESSAGE:
            position += size
            continue
        count = (len(data) - position) // size
        records = data[position : position + count * size].reshape(count, size)
        equal = (records[:, :_SAME] == records[0, :_SAME]).all(axis=1)
        run = count if equal.all() else int(equal.argmin())
        header = records[0, : MESSAGE_HEADER.itemsize].view(MESSAGE_HEADER)[0]
        yield int(header["channel_id"]), records[:run, MESSAGE_HEADER.itemsize :]
        position += run * size


def _decode(path: Path, channel: Channel, layout: Layout, messages: NDArray[np.uint8]) -> Rows:
    if messages.shape[1] != layout.length:
        raise RecordingError(
            f"{path}: a message of channel {channel.name!r} has {messages.shape[1]} bytes, not {layout.length}"
        )
    try:
        return layout.read(messages, channel.width)
    except RecordingError as error:
        raise RecordingError(f"{path}: channel {channel.name!r}: {error}") from None


@cache
def _log_class() -> Any:
    pool = descriptor_pool.DescriptorPool()
    for file in FileDescriptorSet.FromString(log_schema()).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(LOG))


def _log_line(message: NDArray[np.uint8]) -> LogLine:
    log = _log_class().FromString(message.tobytes())
    elapsed_ns = log.timestamp.seconds * 1_000_000_000 + log.timestamp.nanos - EPOCH_NS
    return LogLine(elapsed_ns / 1e9, LOG_LEVELS[log.level], log.message)
