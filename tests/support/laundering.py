"""Recordings as other programs leave them: sorted, merged, compressed anew, without chunks, with fresh checksums."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Callable, Collection
from functools import lru_cache
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import mcap.reader
import zstandard
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC, CompressionType, IndexType, Writer

Found = tuple[Any, Any, Any]


class _Held(NamedTuple):
    """What a recording holds."""

    summary: Any
    attachments: tuple[Any, ...]
    metadata: tuple[Any, ...]
    messages: tuple[Found, ...]


@lru_cache(4)
def _read(data: bytes) -> _Held:
    reader = mcap.reader.make_reader(io.BytesIO(data))
    parts = reader.iter_attachments(), reader.iter_metadata(), reader.iter_messages()
    return _Held(reader.get_summary(), *map(tuple, parts))


def written_anew(
    *sources: Path,
    target: Path,
    order: Callable[[Found], Any] | None = None,
    keep: Callable[[Found], bool] = lambda _: True,
    sequence: Callable[[int], int] = lambda number: number,
    twice: bool = False,
    same_channels: bool = True,
    left_out: Collection[str] = (),
    **options: Any,
) -> Path:
    """Write what recordings hold into one file, by the public reader and writer.

    Args:
        sources: recordings.
        target: the file.
        order: key to sort the messages by; in the order of time without it.
        keep: which messages.
        sequence: a message's number of that before.
        twice: whether each message is written twice.
        left_out: topics that are not even declared.
        same_channels: whether channels alike become one, as `mcap merge` has it.
        options: of the writer.
    """
    with target.open("wb") as file:
        writer = Writer(file, **options)
        writer.start()
        ids: dict[Any, int] = {}
        found: list[tuple[int, Found]] = []
        for k, source in enumerate(sources):
            held = _read(source.read_bytes())
            for each in held.attachments:
                writer.add_attachment(each.create_time, each.log_time, each.name, each.media_type, each.data)
            for each in held.metadata:
                writer.add_metadata(each.name, each.metadata)
            for channel in held.summary.channels.values():
                if channel.topic in left_out:
                    continue
                schema = held.summary.schemas[channel.schema_id]
                key = channel.topic if same_channels else (k, channel.topic)
                if key not in ids:
                    of = writer.register_schema(schema.name, schema.encoding, schema.data)
                    ids[key] = writer.register_channel(channel.topic, "protobuf", of, channel.metadata)
            found += [(k, each) for each in held.messages if keep(each)]
        found.sort(key=lambda each: each[1][2].log_time if order is None else order(each[1]))
        for k, (_, channel, message) in found:
            number = ids[channel.topic if same_channels else (k, channel.topic)]
            for _ in range(1 + twice):
                stamps = message.log_time, message.data, message.publish_time, sequence(message.sequence)
                writer.add_message(number, *stamps)
        writer.finish()
    return target


COMPRESSED = {
    "lz4": {"compression": CompressionType.LZ4},
    "not compressed": {"compression": CompressionType.NONE},
    "large chunks": {"chunk_size": 10**9},
    "small chunks": {"chunk_size": 2_000},
    "no chunks": {"use_chunking": False},
    "no checksums": {"enable_crcs": False},
    "no index": {"index_types": IndexType.NONE, "repeat_channels": False, "use_statistics": False},
}
"""Options of the writer that change nothing of what a file says."""


def with_fresh_checksums(data: bytes, change: Callable[[bytearray], None], random: Random) -> bytes:
    """One record of a file changed inside, and checksums made so that nobody sees it: as `mcap recover` leaves it.

    Args:
        data: a recording.
        change: what is done to the inside of the record.
        random: which record it is.
    """
    places, position = [], len(MCAP0_MAGIC)
    while data[position] != Opcode.DATA_END:
        end = position + 9 + struct.unpack_from("<Q", data, position + 1)[0]
        if data[position] in (Opcode.CHUNK, Opcode.ATTACHMENT, Opcode.METADATA):
            places.append((position, end))
        position = end
    start, end = random.choice(places)
    body = bytearray(data[start + 9 : end])
    if data[start] == Opcode.CHUNK:
        head = body[:36]
        inside = bytearray(zstandard.decompress(bytes(body[44:])))
        change(inside)
        packed = zstandard.compress(bytes(inside))
        struct.pack_into("<QI", head, 16, len(inside), 0 if random.random() < 0.5 else zlib.crc32(inside))
        body = head + struct.pack("<Q", len(packed)) + packed
    else:
        change(body)
        if data[start] == Opcode.ATTACHMENT:
            body[-4:] = zlib.crc32(body[:-4]).to_bytes(4, "little")
    changed = data[:start] + data[start : start + 1] + struct.pack("<Q", len(body)) + body + data[end:position]
    footer = struct.pack("<BQQQI", Opcode.FOOTER, 20, 0, 0, 0)
    return changed + struct.pack("<BQI", Opcode.DATA_END, 4, 0) + footer + MCAP0_MAGIC
