"""The records of an MCAP file, as far as the file goes.

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

Record = TypeVar("Record", Attachment, Chunk, DataEnd, Metadata)
_PREFIX = 9  # opcode and length of a record
_SAME = 11  # and the channel id of a message


@dataclass
class McapContents:
    """What an MCAP file holds.

    Attributes:
        metadata: tables of texts by name.
        attachments: files by name.
        complete: whether the file has its end.
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    complete: bool = False


def read_contents(path: Path, take: Callable[[bytes], None] = lambda chunk: None) -> McapContents:
    """Read an MCAP file up to its end or up to where it was cut off.

    Args:
        path: the file.
        take: called with the uncompressed records of each chunk, in file order.

    Raises:
        RecordingError: no such file, not an MCAP, or one that is damaged.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    if not data.startswith(MCAP0_MAGIC):
        raise RecordingError(f"{path} is not an MCAP file")
    contents = McapContents()
    for position, opcode, body in _records(data, len(MCAP0_MAGIC)):
        if opcode == Opcode.METADATA:
            metadata = _read(path, Metadata, body)
            contents.metadata[metadata.name] = metadata.metadata
        elif opcode == Opcode.ATTACHMENT:
            attachment = _read(path, Attachment, body)
            if zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "little"):
                raise RecordingError(f"{path}: attachment {attachment.name!r} is damaged")
            contents.attachments[attachment.name] = attachment.data
        elif opcode == Opcode.CHUNK:
            take(_uncompressed(path, _read(path, Chunk, body)))
        elif opcode == Opcode.DATA_END:
            checksum = _read(path, DataEnd, body).data_section_crc
            if checksum and checksum != zlib.crc32(data[:position]):
                raise RecordingError(f"{path} is damaged: its contents do not fit their checksum")
            _check_summary(path, data, position + _PREFIX + len(body))
            contents.complete = data.endswith(MCAP0_MAGIC)
            break
    return contents


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
                yield _uncompressed(path, _read(path, Chunk, body))
            else:
                file.seek(length, 1)


def _check_summary(path: Path, data: bytes, start: int) -> None:
    """Hold the summary that starts at ``start`` against its checksum, the last four bytes before the magic."""
    end = len(data) - len(MCAP0_MAGIC) - 4
    checksum = int.from_bytes(data[end : end + 4], "little")
    if data.endswith(MCAP0_MAGIC) and checksum and checksum != zlib.crc32(data[start:end]):
        raise RecordingError(f"{path} is damaged: its summary does not fit its checksum")


def _records(data: bytes, position: int) -> Iterator[tuple[int, int, bytes]]:
    """Walk the whole records from ``position`` on: (where it starts, opcode, body)."""
    while position + _PREFIX <= len(data):
        end = position + _PREFIX + int.from_bytes(data[position + 1 : position + _PREFIX], "little")
        if end > len(data):
            return
        yield position, data[position], data[position + _PREFIX : end]
        position = end


def _read(path: Path, kind: type[Record], body: bytes) -> Record:
    # The library has no one exception for a record whose lengths or texts are damaged.
    try:
        return kind.read(ReadDataStream(BytesIO(body)))
    except Exception as error:
        raise RecordingError(f"{path} is damaged: a record of kind {kind.__name__} cannot be read") from error


def _uncompressed(path: Path, chunk: Chunk) -> bytes:
    # zstandard and lz4 have exceptions of their own for data that cannot be decompressed.
    try:
        stream, length = get_chunk_data_stream(chunk, validate_crc=True)
    except CRCValidationError:
        raise RecordingError(f"{path} is damaged: a chunk does not fit its checksum") from None
    except Exception as error:
        raise RecordingError(f"{path} is damaged: a chunk cannot be decompressed ({error})") from error
    return stream.read(length)


@dataclass(frozen=True)
class ChunkPlaces:
    """Where the records of a chunk are.

    Attributes:
        channels: that it declares.
        messages: by channel and size of their records, where these start.
    """

    channels: list[Channel]
    messages: dict[tuple[int, int], list[int]]


def places_of(chunk: bytes) -> ChunkPlaces:
    """Find the records of a chunk, in whatever order its messages are."""
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
                    channels.append(Channel.read(ReadDataStream(BytesIO(body))))
                position += size
                continue
            starts = messages.setdefault((int.from_bytes(head[_PREFIX:], "little"), size), [])
            known[head] = starts.append, size
        note, size = known[head]
        note(position)
        position += size
    return ChunkPlaces(channels, messages)
