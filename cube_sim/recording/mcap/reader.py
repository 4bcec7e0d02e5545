"""The records of an MCAP file, whoever wrote it, as far as the file goes.

``mcap.make_reader`` wants the index at the end, which a killed writer never wrote; this walks the file from
its beginning, checks every checksum, and stops where the last whole record ends.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import TypeVar

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Metadata
from mcap.stream_reader import CRCValidationError, get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

from cube_sim.errors import RecordingError
from cube_sim.recording.mcap.fixed_width import MESSAGE_HEADER
from cube_sim.recording.mcap.names import seconds

Record = TypeVar("Record", Attachment, Channel, Chunk, DataEnd, Metadata)
_PREFIX = 9  # opcode and length of a record
_SAME = 11  # and the channel id of a message
LOOSE = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE)
"""What stands outside chunks where a writer makes none."""


@dataclass
class McapContents:
    """What an MCAP file holds.

    Attributes:
        path: the file.
        metadata: tables of texts by name.
        attachments: files by name.
        twice: names of tables and files of which there are two that are not the same.
        complete: whether the file has its end.
    """

    path: Path
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    twice: list[str] = field(default_factory=list)
    complete: bool = False
    _chunks: list[tuple[int, int]] = field(default_factory=list)
    _loose: list[tuple[int, int]] = field(default_factory=list)
    _data: bytes = b""

    def chunks(self) -> Iterator[bytes]:
        """The uncompressed records of each chunk, in file order; those outside chunks come last.

        Raises:
            RecordingError: a chunk is damaged.
        """
        for start, end in self._chunks:
            yield uncompressed(self.path, read_record(self.path, Chunk, self._data[start:end]))
        if self._loose:
            yield b"".join(self._data[start:end] for start, end in self._loose)

    def add_table(self, table: Metadata) -> None:
        """Take in a table of texts."""
        if self.metadata.setdefault(table.name, table.metadata) != table.metadata:
            self.twice.append(table.name)

    def add_file(self, name: str, data: bytes) -> None:
        """Take in a file."""
        if self.attachments.setdefault(name, data) != data:
            self.twice.append(name)


def read_contents(path: Path) -> McapContents:
    """Read an MCAP file up to its end or up to where it was cut off.

    Args:
        path: the file.

    Raises:
        RecordingError: no such file, not an MCAP, or one that is damaged.
    """
    data = read_bytes(path)
    contents = McapContents(path, _data=data)
    for position, opcode, end in records(data, len(MCAP0_MAGIC)):
        if opcode in LOOSE:
            if contents._loose and contents._loose[-1][1] == position:
                position = contents._loose.pop()[0]
            contents._loose.append((position, end))
            continue
        if opcode == Opcode.CHUNK:
            contents._chunks.append((position + _PREFIX, end))
            continue
        body = data[position + _PREFIX : end]
        if opcode == Opcode.METADATA:
            contents.add_table(read_record(path, Metadata, body))
        elif opcode == Opcode.ATTACHMENT:
            attachment = read_record(path, Attachment, body)
            if not attachment_is_sound(body):
                raise RecordingError(f"{path} is damaged: attachment {attachment.name!r} does not fit its checksum")
            contents.add_file(attachment.name, attachment.data)
        elif opcode == Opcode.DATA_END:
            checksum = read_record(path, DataEnd, body).data_section_crc
            if checksum and checksum != zlib.crc32(memoryview(data)[:position]):
                list(contents.chunks())  # names the one that is damaged, if it is one
                raise RecordingError(f"{path} is damaged: its contents do not fit their checksum")
            _check_summary(path, data, end)
            contents.complete = data.endswith(MCAP0_MAGIC)
            break
    return contents


def read_bytes(path: Path) -> bytes:
    """An MCAP file as it is.

    Raises:
        RecordingError: no such file, or not an MCAP.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    if not data.startswith(MCAP0_MAGIC):
        raise RecordingError(f"{path} is not an MCAP file")
    return data


def attachment_is_sound(body: bytes) -> bool:
    """Whether an attachment fits its checksum, where it has one."""
    checksum = int.from_bytes(body[-4:], "little")
    return checksum in (0, zlib.crc32(body[:-4]))


def chunks_of(path: Path) -> Iterator[bytes]:
    """The uncompressed records of each chunk of an MCAP file, one chunk in memory at a time.

    Checksums of chunks are checked, that of the whole file is not.

    Args:
        path: the file.

    Raises:
        RecordingError: no such file, or a checksum that does not fit.
    """
    try:
        file = path.open("rb")
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    with file:
        file.seek(len(MCAP0_MAGIC))
        while len(head := file.read(_PREFIX)) == _PREFIX:
            opcode, length = head[0], int.from_bytes(head[1:], "little")
            if opcode == Opcode.DATA_END:
                return
            if opcode == Opcode.CHUNK:
                body = file.read(length)
                if len(body) < length:
                    return
                yield uncompressed(path, read_record(path, Chunk, body))
            else:
                file.seek(length, 1)


def _check_summary(path: Path, data: bytes, start: int) -> None:
    """Hold the summary that starts at ``start`` against its checksum, the last four bytes before the magic."""
    end = len(data) - len(MCAP0_MAGIC) - 4
    checksum = int.from_bytes(data[end : end + 4], "little")
    if data.endswith(MCAP0_MAGIC) and checksum and checksum != zlib.crc32(memoryview(data)[start:end]):
        raise RecordingError(f"{path} is damaged: its summary does not fit its checksum")


def records(data: bytes, position: int) -> Iterator[tuple[int, int, int]]:
    """Walk the whole records from ``position`` on: (where it starts, opcode, where it ends)."""
    size = len(data)
    while position + _PREFIX <= size:
        end = position + _PREFIX + int.from_bytes(data[position + 1 : position + _PREFIX], "little")
        if end > size:
            return
        yield position, data[position], end
        position = end


def read_record(path: Path, kind: type[Record], body: bytes) -> Record:
    """A record of the bytes that follow its length.

    Raises:
        RecordingError: they are none.
    """
    # The library has no one exception for a record whose lengths or texts are damaged.
    try:
        return kind.read(ReadDataStream(BytesIO(body)))
    except Exception as error:
        raise RecordingError(f"{path} is damaged: a record of kind {kind.__name__} cannot be read") from error


def uncompressed(path: Path, chunk: Chunk) -> bytes:
    """The records in a chunk.

    Raises:
        RecordingError: it does not fit its checksum, or cannot be decompressed; the text says which it is.
    """
    which = f"the chunk from {seconds(chunk.message_start_time):g} s to {seconds(chunk.message_end_time):g} s"
    # zstandard and lz4 have exceptions of their own for data that cannot be decompressed.
    try:
        stream, length = get_chunk_data_stream(chunk, validate_crc=True)
        return stream.read(length)
    except CRCValidationError:
        why = "does not fit its checksum"
    except Exception as error:
        why = f"cannot be decompressed ({' '.join(str(error).split())})"
    raise RecordingError(f"{path} is damaged: {which} {why}; `cube-sim recover` saves the others")


@dataclass(frozen=True)
class ChunkPlaces:
    """Where the records of a chunk are.

    Attributes:
        channels: that it declares.
        messages: by channel and size of their records, where these start.
    """

    channels: list[Channel]
    messages: dict[tuple[int, int], list[int]]


def places_of(path: Path, chunk: bytes) -> ChunkPlaces:
    """Find the records of a chunk, in whatever order its messages are.

    Raises:
        RecordingError: its records are not whole.
    """
    channels: list[Channel] = []
    messages: dict[tuple[int, int], list[int]] = {}
    # Opcode, length and channel of a message are all there is to know of it: alike in these is looked at once.
    known: dict[bytes, tuple[Callable[[int], None], int]] = {}
    position, end = 0, len(chunk)
    while position < end:
        head = chunk[position : position + _SAME]
        if head not in known:
            size = _PREFIX + int.from_bytes(head[1:_PREFIX], "little")
            if head[0] != Opcode.MESSAGE:
                if head[0] == Opcode.CHANNEL:
                    body = chunk[position + _PREFIX : position + size]
                    channels.append(read_record(path, Channel, body))
                position += size
                continue
            if size < MESSAGE_HEADER.itemsize:
                raise RecordingError(f"{path} is damaged: a message is shorter than what precedes one")
            starts = messages.setdefault((int.from_bytes(head[_PREFIX:], "little"), size), [])
            known[head] = starts.append, size
        note, size = known[head]
        note(position)
        position += size
    if position > end:
        raise RecordingError(f"{path} is damaged: the records of a chunk go on beyond it")
    return ChunkPlaces(channels, messages)
