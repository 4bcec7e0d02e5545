"""An MCAP file gone through once from its beginning, one record of it in memory at a time."""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode
from mcap.records import Attachment, Chunk, DataEnd, Metadata
from mcap.writer import MCAP0_MAGIC

from cube_sim.errors import RecordingError
from cube_sim.recording.mcap.reader import LOOSE, McapContents, attachment_is_sound, read_record, uncompressed

_PREFIX = 9  # opcode and length of a record
_PIECE = 1_000_000
"""So many bytes of the summary are looked at together."""


class NotInOrderError(RecordingError):
    """A record that has to be read as a whole: its rows are not written in the order of time."""


def chunks_in_passing(contents: McapContents) -> Iterator[bytes]:
    """The uncompressed records of each chunk, in file order, every checksum checked.

    Args:
        contents: of the file; takes in its tables and files as they come, and at last whether it has its end.

    Raises:
        NotInOrderError: messages stand outside chunks, or it ends amid its summary.
        RecordingError: no such file, not an MCAP, or one that is damaged.
    """
    path = contents.path
    try:
        file = path.open("rb")
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror}") from None
    with file:
        size = os.fstat(file.fileno()).st_size
        checksum = zlib.crc32(magic := file.read(len(MCAP0_MAGIC)))
        if magic != MCAP0_MAGIC:
            raise RecordingError(f"{path} is not an MCAP file")
        position = len(magic)
        while len(head := file.read(_PREFIX)) == _PREFIX:
            opcode, length = head[0], int.from_bytes(head[1:], "little")
            position += _PREFIX + length
            if position > size:
                return
            if opcode in LOOSE:
                raise NotInOrderError(f"{path} has messages outside chunks")
            body = file.read(length)
            if opcode == Opcode.DATA_END:
                told = read_record(path, DataEnd, body).data_section_crc
                if told and told != checksum:
                    raise RecordingError(f"{path} is damaged: its contents do not fit their checksum")
                contents.complete = _has_its_end(path, file, size)
                return
            checksum = zlib.crc32(body, zlib.crc32(head, checksum))
            if opcode == Opcode.CHUNK:
                yield uncompressed(path, read_record(path, Chunk, body))
            elif opcode == Opcode.METADATA:
                contents.add_table(read_record(path, Metadata, body))
            elif opcode == Opcode.ATTACHMENT:
                attachment = read_record(path, Attachment, body)
                if not attachment_is_sound(body):
                    raise RecordingError(f"{path} is damaged: attachment {attachment.name!r} does not fit its checksum")
                contents.add_file(attachment.name, attachment.data)


def _has_its_end(path: Path, file: BinaryIO, size: int) -> bool:
    """Whether a file that has been read up to its summary ends as it should, and holds that against its checksum."""
    checksum, left = 0, size - len(MCAP0_MAGIC) - 4 - file.tell()
    if left < 0:
        raise NotInOrderError(f"{path} ends amid its summary")
    while left > 0 and (piece := file.read(min(left, _PIECE))):
        checksum, left = zlib.crc32(piece, checksum), left - len(piece)
    rest = file.read()
    complete = rest.endswith(MCAP0_MAGIC)
    told = int.from_bytes(rest[:4], "little")
    if complete and told and told != checksum:
        raise RecordingError(f"{path} is damaged: its summary does not fit its checksum")
    return complete
