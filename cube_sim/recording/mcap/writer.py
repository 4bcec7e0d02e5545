"""An MCAP file written a batch at a time.

The public ``mcap`` writer takes one message per call, which is most of the time a recording costs. Messages
of constant length need no such call: a batch of them, and its index, are arrays. Everything else in the file
is written with the ``mcap`` package's own records (format: mcap.dev/spec).
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping
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
    Chunk,
    ChunkIndex,
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

# Fixed, so that a file does not depend on the release of a library that had no say in its bytes.
LIBRARY = "cube_sim"
COMPRESSION_LEVEL = 1

MESSAGE_HEADER = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel_id", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
_INDEX_ENTRY = np.dtype([("log_time", "<u8"), ("offset", "<u8")])
# Bytes of a message record that its length field counts, besides the message itself.
_COUNTED_HEADER = MESSAGE_HEADER.itemsize - 9


@dataclass(frozen=True)
class MessageBatch:
    """Messages of one channel, as the bytes of their MCAP records.

    Attributes:
        channel_id: the channel.
        log_times: (n,) ns.
        data: the n records, one after another.
        offsets: (n,) where each record starts in ``data``.
    """

    channel_id: int
    log_times: NDArray[np.uint64]
    data: bytes
    offsets: NDArray[np.uint64]


def message_records(
    channel_id: int, log_times: NDArray[np.uint64], first_sequence: int, length: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Prepare the MCAP records of n messages of equal length.

    Args:
        channel_id: the channel.
        log_times: (n,) ns.
        first_sequence: sequence number of the first.
        length: bytes per message.

    Returns:
        The records (n, 31 + length) with their headers filled in, and the view (n, length) of them
        into which the messages belong.
    """
    n = len(log_times)
    records = np.empty((n, MESSAGE_HEADER.itemsize + length), np.uint8)
    header = np.empty(n, MESSAGE_HEADER)
    header["opcode"] = Opcode.MESSAGE
    header["length"] = _COUNTED_HEADER + length
    header["channel_id"] = channel_id
    header["sequence"] = np.arange(first_sequence, first_sequence + n)
    header["log_time"] = header["publish_time"] = log_times
    records[:, : MESSAGE_HEADER.itemsize] = header.view(np.uint8).reshape(n, -1)
    return records, records[:, MESSAGE_HEADER.itemsize :]


class McapWriter:
    """Writes metadata and attachments, then chunks, then the summary.

    Attributes:
        path: the file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = path.open("wb")
        self._compressor = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL)
        self._position = 0
        self._crc = 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._declared = RecordBuilder()
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._chunks: list[bytes] = []  # encoded at once: a long run has many
        self._counts: dict[int, int] = {}
        self._times: tuple[int, int] | None = None
        self._write(MCAP0_MAGIC)
        self._write_record(Header(profile="", library=LIBRARY))

    def add_metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Write a named table of texts."""
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
        self._schemas[-1].write(self._declared)
        self._channels[-1].write(self._declared)
        return number

    def write_chunk(self, batches: Iterable[MessageBatch]) -> None:
        """Write messages as one chunk with its index, and hand them to the operating system.

        Args:
            batches: at most one per channel, none of them empty. No chunk is written without messages.
        """
        batches = tuple(batches)
        if not batches:
            return
        declared = self._declared.end()
        data = declared + b"".join(batch.data for batch in batches)
        start = min(int(batch.log_times.min()) for batch in batches)
        end = max(int(batch.log_times.max()) for batch in batches)
        compressed = self._compressor.compress(data)
        chunk_start = self._position
        self._write_record(
            Chunk(
                compression="zstd",
                data=compressed,
                message_start_time=start,
                message_end_time=end,
                uncompressed_crc=zlib.crc32(data),
                uncompressed_size=len(data),
            )
        )
        chunk_length = self._position - chunk_start
        offset, index_offsets = len(declared), {}
        for batch in batches:
            index_offsets[batch.channel_id] = self._position
            self._write(_message_index(batch, offset))
            self._counts[batch.channel_id] = self._counts.get(batch.channel_id, 0) + len(batch.log_times)
            offset += len(batch.data)
        self._chunks.append(
            _encoded(
                ChunkIndex(
                    message_start_time=start,
                    message_end_time=end,
                    chunk_start_offset=chunk_start,
                    chunk_length=chunk_length,
                    message_index_offsets=index_offsets,
                    message_index_length=self._position - chunk_start - chunk_length,
                    compression="zstd",
                    compressed_size=len(compressed),
                    uncompressed_size=len(data),
                )
            )
        )
        first, last = self._times or (start, end)
        self._times = (min(first, start), max(last, end))
        self._file.flush()

    def close(self) -> None:
        """Write the summary and close the file."""
        if self._file.closed:
            return
        self._write_record(DataEnd(data_section_crc=self._crc))
        summary_start = self._position
        summary, offsets = b"", []
        for opcode, records in self._summary():
            start, summary = len(summary), summary + b"".join(records)
            if len(summary) > start:
                offsets.append(SummaryOffset(opcode, summary_start + start, len(summary) - start))
        offset_start = summary_start + len(summary)
        footer = _encoded(Footer(summary_start=summary_start, summary_offset_start=offset_start, summary_crc=0))
        # The checksum covers the summary and the footer up to the checksum itself.
        closing = summary + b"".join(_encoded(offset) for offset in offsets) + footer[:-4]
        self._write(closing + zlib.crc32(closing).to_bytes(4, "little") + MCAP0_MAGIC)
        self._file.close()

    def _summary(self) -> list[tuple[Opcode, list[bytes]]]:
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
        self._file.write(data)
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


def _message_index(batch: MessageBatch, base: int) -> bytes:
    """Build the MessageIndex record of a batch that starts at byte ``base`` of its chunk."""
    entries = np.empty(len(batch.log_times), _INDEX_ENTRY)
    entries["log_time"] = batch.log_times
    entries["offset"] = batch.offsets + np.uint64(base)
    listed = entries.tobytes()
    body = batch.channel_id.to_bytes(2, "little") + len(listed).to_bytes(4, "little") + listed
    return bytes([Opcode.MESSAGE_INDEX]) + len(body).to_bytes(8, "little") + body
