"""What is left of a damaged recording: chunks that fit their checksum are kept, the others dropped."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, Metadata
from mcap.writer import MCAP0_MAGIC

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.recording.mcap.names import RUN_METADATA
from cube_sim.recording.mcap.reader import (
    LOOSE,
    McapContents,
    attachment_is_sound,
    places_of,
    read_bytes,
    read_record,
    records,
    uncompressed,
)
from cube_sim.recording.messages import RecordedMessages
from cube_sim.recording.reading import Recording, read_end, read_header
from cube_sim.run_log import LogLine

_CHUNK_HEAD = 37
"""Bytes of a chunk before the name of its compression."""
_LANDMARK = re.compile(rb"\x04\0\0\0zstd|\x03\0\0\0lz4|\x03\0\0\0end")
"""By which a record is found behind one whose length is damaged: a chunk's compression, the name of the end."""


@dataclass(frozen=True)
class Salvaged:
    """What is left.

    Attributes:
        recording: its rows and lines in the order of time; it has a flaw unless all is there.
        dropped: what could not be read, a line each.
    """

    recording: Recording
    dropped: tuple[str, ...]


def salvage(path: Path) -> Salvaged:
    """Read whatever can be read of a recording.

    Args:
        path: the MCAP file: cut off, with damaged places, or both.

    Raises:
        RecordingError: nothing can be read: no such file, its inputs are lost, or it has not one whole chunk.
    """
    parts = _Parts(path)
    header, vehicle = read_header(parts.contents)
    format_ = parts.contents.metadata[RUN_METADATA]["format"]
    channels: list[Channel] = []
    for chunk in parts.chunks:
        channels += places_of(path, chunk).channels
    channels += parts.channels
    rows: dict[str, list[Rows]] = {}
    lines: list[LogLine] = []
    messages = RecordedMessages(path, format_)
    for chunk in parts.chunks:
        messages = RecordedMessages(path, format_)
        try:
            for channel in channels:
                messages.declare(channel)
            messages.take(chunk)
            found, said = messages.rows(), messages.lines()
        except RecordingError as error:
            parts.drop(error)
            continue
        for name, some in found.items():
            rows.setdefault(name, []).append(some)
        lines += said
    if not messages.channels:
        raise RecordingError(f"{path}: nothing can be recovered: not one of its chunks is whole")
    read = Recording(
        header=header,
        vehicle=vehicle,
        channels=tuple(messages.channels.values()),
        rows={name: whole for name, some in rows.items() if len(whole := _in_time(some))},
        log=tuple(sorted(lines, key=lambda line: line.t)),
    )
    return Salvaged(read_end(parts.contents, read), tuple(parts.dropped))


def _in_time(parts: list[Rows]) -> Rows:
    """Rows in the order of time; where a chunk is there twice, its rows are there once."""
    rows = np.concatenate(parts)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    again = np.zeros(len(rows), bool)
    again[1:] = (rows[1:].view(np.int64) == rows[:-1].view(np.int64)).all(axis=1)
    return rows[~again]


class _Parts:
    """The sound parts of a file.

    Attributes:
        contents: tables and files.
        chunks: uncompressed.
        channels: declared outside chunks, as in the summary.
        dropped: what is not sound, a line each.
    """

    def __init__(self, path: Path) -> None:
        self.contents = McapContents(path)
        self.chunks: list[bytes] = []
        self.channels: list[Channel] = []
        self.dropped: list[str] = []
        data, loose = read_bytes(path), []
        position = len(MCAP0_MAGIC)
        while position < len(data) - len(MCAP0_MAGIC):
            found = next(records(data, position), None)
            if found is None or not Opcode.HEADER <= found[1] <= Opcode.DATA_END:
                self.dropped.append("a record whose length makes no sense, or the end of a file that was cut off")
                position = _landmark(data, position + 1, len(data))
                continue
            start, opcode, position = found
            try:
                self._take(path, opcode, data[start + 9 : position])
            except RecordingError as error:
                self.drop(error)
                position = _landmark(data, start + 1, position)  # it may be its length that is damaged
            if opcode in LOOSE:
                loose.append(data[start:position])
            if opcode == Opcode.FOOTER:
                self.contents.complete = data.endswith(MCAP0_MAGIC)
                if position < len(data) - len(MCAP0_MAGIC):
                    self.dropped.append("what comes after the record's end: another file, it may be")
                break
        if loose:
            self.chunks.append(b"".join(loose))

    def drop(self, error: RecordingError) -> None:
        """Note that something cannot be read."""
        self.dropped.append(str(error).removeprefix(f"{self.contents.path} is damaged: ").partition(";")[0])

    def _take(self, path: Path, opcode: int, body: bytes) -> None:
        if opcode == Opcode.METADATA:
            self.contents.add_table(read_record(path, Metadata, body))
        elif opcode == Opcode.ATTACHMENT:
            attachment = read_record(path, Attachment, body)
            if not attachment_is_sound(body):
                raise RecordingError(f"{path} is damaged: the file {attachment.name!r} in it")
            self.contents.add_file(attachment.name, attachment.data)
        elif opcode == Opcode.CHANNEL:
            self.channels.append(read_record(path, Channel, body))
        elif opcode == Opcode.CHUNK:
            chunk = uncompressed(path, read_record(path, Chunk, body))
            places_of(path, chunk)
            self.chunks.append(chunk)


def _landmark(data: bytes, position: int, otherwise: int) -> int:
    """Where the next whole chunk, or the end, seems to start; another place where there is none."""
    for found in _LANDMARK.finditer(data, position):
        is_end = found[0].endswith(b"end")
        start = found.start() - (9 if is_end else _CHUNK_HEAD)
        if start >= position and data[start] == (Opcode.METADATA if is_end else Opcode.CHUNK):
            length = int.from_bytes(data[start + 1 : start + 9], "little")
            if start + 9 + length <= len(data):
                return start
    return otherwise
