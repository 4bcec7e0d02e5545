"""An MCAP file written a chunk at a time.

The public ``mcap`` writer takes one message per call, which is most of the time a recording costs. Here the records of
a chunk and their index come as bytes (`encoding`). What is written once is written with the ``mcap`` package's own
records (format: mcap.dev/spec).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC
from numpy.typing import NDArray

from cube_sim.recording.mcap.encoding import INDEX_ENTRY, INDEX_HEAD
from cube_sim.recording.mcap.many_records import ManyRecords

# Fixed, so that a file does not depend on the release of a library that had no say in its bytes.
LIBRARY = "cube_sim"
COMPRESSION_LEVEL = 1

_COMPRESSION = b"zstd"
_CHUNK = struct.Struct(f"<BQQQQII{len(_COMPRESSION)}sQ")
"""A chunk up to its records: opcode, length, first and last time, size, checksum, compression, compressed size."""


@dataclass(frozen=True)
class Messages:
    """Messages of a chunk in the order of time.

    Attributes:
        chunk: bytes of their records, behind `McapWriter.ahead` bytes that the writer fills.
        index: bytes of their message index records, one per channel.
        channels: id and number of messages of each channel, in the order of the index.
        start: first time [ns].
        end: last time [ns].
    """

    chunk: NDArray[np.uint8]
    index: NDArray[np.uint8]
    channels: Sequence[tuple[int, int]]
    start: int
    end: int


class McapWriter:
    """Writes metadata and attachments, then chunks, then the summary.

    Attributes:
        path: the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = path.open("wb", buffering=0)
        self._compressor = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL)
        self._position = 0
        self._crc = 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._declared = b""
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._chunks = ManyRecords()
        self._counts: dict[int, int] = {}
        self._times: tuple[int, int] | None = None
        self._write(MCAP0_MAGIC)
        self._write_record(Header(profile="", library=LIBRARY))

    def move_to(self, path: Path) -> None:
        """Go on at another place, in the same folder; what is there is replaced.

        Raises:
            OSError: it cannot be put there.
        """
        self._file.close()  # not every system moves a file that is open
        self.path.replace(path)
        self.path, self._file = path, path.open("r+b", buffering=0)
        self._file.seek(self._position)

    def add_metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Write a named table of texts, before the chunks or after them."""
        offset = self._position
        self._write_record(Metadata(name=name, metadata=dict(data)))
        self._metadata.append(MetadataIndex(offset=offset, length=self._position - offset, name=name))

    def add_attachment(self, name: str, media_type: str, data: bytes, log_time: int) -> None:
        """Write a whole file into the recording."""
        offset = self._position
        self._write_record(Attachment(create_time=0, log_time=log_time, name=name, media_type=media_type, data=data))
        self._attachments.append(
            AttachmentIndex(
                offset=offset,
                length=self._position - offset,
                log_time=log_time,
                create_time=0,
                data_size=len(data),
                name=name,
                media_type=media_type,
            )
        )

    def add_channel(
        self, topic: str, schema_name: str, schema: bytes, metadata: Mapping[str, str] | None = None
    ) -> int:
        """Declare a channel of protobuf messages; it is written with the next chunk.

        Returns:
            The id of the channel.
        """
        number = len(self._channels) + 1
        self._schemas.append(Schema(id=number, name=schema_name, encoding="protobuf", data=schema))
        self._channels.append(
            Channel(
                id=number,
                topic=topic,
                message_encoding="protobuf",
                metadata=dict(metadata or {}),
                schema_id=number,
            )
        )
        self._declared += _encoded(self._schemas[-1]) + _encoded(self._channels[-1])
        return number

    @property
    def closed(self) -> bool:
        """Whether nothing can be written any more."""
        return self._file.closed

    @property
    def ahead(self) -> int:
        """Bytes of the next chunk that come before its first message."""
        return len(self._declared)

    def write_chunk(self, messages: Messages) -> None:
        """Write messages as one chunk with its index, and hand them to the operating system."""
        chunk, start, end = messages.chunk, messages.start, messages.end
        chunk[: self.ahead] = np.frombuffer(self._declared, np.uint8)
        self._declared = b""
        compressed = self._compressor.compress(chunk.data)
        size, packed = len(chunk), len(compressed)
        length = _CHUNK.size + packed
        head = _CHUNK.pack(
            Opcode.CHUNK, length - 9, start, end, size, zlib.crc32(chunk.data), len(_COMPRESSION), _COMPRESSION, packed
        )
        position, offsets, entries = self._position, [], len(messages.index)
        at = position + length
        self._write(b"".join((head, compressed, messages.index.data)))
        for channel_id, count in messages.channels:
            offsets += [channel_id, at]
            at += INDEX_HEAD + INDEX_ENTRY * count
            self._counts[channel_id] = self._counts.get(channel_id, 0) + count
        self._chunks.append(
            struct.pack(
                f"<BQQQQQI{'HQ' * len(messages.channels)}QI{len(_COMPRESSION)}sQQ",
                Opcode.CHUNK_INDEX,
                64 + len(_COMPRESSION) + 10 * len(messages.channels),
                start,
                end,
                position,
                length,
                10 * len(messages.channels),
                *offsets,
                entries,
                len(_COMPRESSION),
                _COMPRESSION,
                packed,
                size,
            )
        )
        first, last = self._times or (start, end)
        self._times = (min(first, start), max(last, end))

    def close(self) -> None:
        """Write the summary and close the file.

        Raises:
            OSError: there is no room for the summary. The file is closed without it, which readers can do without.
        """
        if self._file.closed:
            return
        try:
            self._end()
        finally:
            self._file.close()

    def _end(self) -> None:
        end, crc = self._position, self._crc
        try:
            self._file.truncate()  # of what there was no room for, a part may be there
            self._write_record(DataEnd(data_section_crc=crc))
            self._write_summary()
        except OSError:
            self._file.seek(end)
            self._file.truncate()
            with suppress(OSError):
                footer = _encoded(Footer(summary_start=0, summary_offset_start=0, summary_crc=0))
                self._write(_encoded(DataEnd(data_section_crc=crc)) + footer + MCAP0_MAGIC)
            raise

    def _write_summary(self) -> None:
        summary_start, self._crc = self._position, 0  # the second checksum covers what follows up to itself
        offsets = []
        for opcode, records in self._summary():
            start = self._position
            for record in records:
                self._write(record)
            if self._position > start:
                offsets.append(SummaryOffset(opcode, start, self._position - start))
        offset_start = self._position
        for offset in offsets:
            self._write_record(offset)
        footer = _encoded(Footer(summary_start=summary_start, summary_offset_start=offset_start, summary_crc=0))
        self._write(footer[:-4])
        self._write(self._crc.to_bytes(4, "little") + MCAP0_MAGIC)

    def _summary(self) -> list[tuple[Opcode, Iterable[bytes]]]:
        start, end = self._times or (0, 0)
        statistics = Statistics(
            message_count=sum(self._counts.values()),
            schema_count=len(self._schemas),
            channel_count=len(self._channels),
            attachment_count=len(self._attachments),
            metadata_count=len(self._metadata),
            chunk_count=len(self._chunks),
            message_start_time=start,
            message_end_time=end,
            channel_message_counts=dict(sorted(self._counts.items())),
        )
        return [
            (Opcode.SCHEMA, [_encoded(schema) for schema in self._schemas]),
            (Opcode.CHANNEL, [_encoded(channel) for channel in self._channels]),
            (Opcode.STATISTICS, [_encoded(statistics)]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, [_encoded(attachment) for attachment in self._attachments]),
            (Opcode.METADATA_INDEX, [_encoded(metadata) for metadata in self._metadata]),
        ]

    def _write_record(self, record: McapRecord) -> None:
        self._write(_encoded(record))

    def _write(self, data: bytes) -> None:
        """Hand bytes to the operating system, all of them; of those that did not go there nothing is counted."""
        try:
            rest = memoryview(data)
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError:
            self._file.seek(self._position)
            raise
        self._position += len(data)
        self._crc = zlib.crc32(data, self._crc)

    def __enter__(self) -> McapWriter:
        """Use as a context manager."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Finish the file, whatever happened."""
        self.close()


def _encoded(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return builder.end()
