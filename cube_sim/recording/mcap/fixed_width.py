"""Protobuf messages of constant length: where their numbers lie.

A channel's message is ``double t = 1`` and then each field, its numbers by name (`named_fields`). Whatever a row holds,
tags and lengths never change, so n messages are an (n, L) array of bytes in which only the columns of the numbers
differ. Any protobuf reader decodes it; none is needed to write it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from cube_sim.errors import RecordingError
from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.named_fields import Code, Group, Numbers, Part, parts_of

Span = tuple[int, int, int]
_MOST_KEPT = 64
"""So many layouts are kept: a damaged record declares its channels again with each piece that is tried."""
_VARINT, _DOUBLE, _BYTES = 0, 1, 2  # protobuf wire types: small integers, 64 bits, length-delimited

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
"""What precedes a message in its MCAP record; `length` counts what follows itself."""

_COUNTED_HEADER = MESSAGE_HEADER.itemsize - 9


def varint(value: int) -> bytes:
    """Encode a non-negative integer in protobuf's base-128 form."""
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def tag(number: int, wire_type: int) -> bytes:
    """Encode the key that precedes a field's value."""
    return varint(number << 3 | wire_type)


def double_tag(number: int) -> bytes:
    """Encode the key of a ``double`` field."""
    return tag(number, _DOUBLE)


def length_prefix(number: int, length: int) -> bytes:
    """Encode the key and length of a string, message or packed field."""
    return tag(number, _BYTES) + varint(length)


@dataclass(frozen=True)
class Layout:
    """Where the numbers of a row lie in the bytes of its message.

    Attributes:
        template: (L,) uint8, one message with zero numbers.
        spans: for each run of adjacent numbers: first byte, first column, number of columns; 0 for a code, which is one
            byte.
        constant: (L,) bool, True where the bytes are the same in every message.
    """

    template: NDArray[np.uint8]
    spans: tuple[tuple[int, int, int], ...]
    constant: NDArray[np.bool_]

    @property
    def length(self) -> int:
        """Bytes per message."""
        return self.template.size

    def read(self, data: NDArray[np.uint8], width: int) -> NDArray[np.float64]:
        """Decode bytes into rows.

        Args:
            data: (n, L) uint8.
            width: numbers per row, the time not counted.

        Returns:
            (n, 1+width), column 0 the time [s].

        Raises:
            RecordingError: the bytes are not messages of this layout.
        """
        if not np.array_equal(data[:, self.constant], np.broadcast_to(self.template, data.shape)[:, self.constant]):
            raise RecordingError("a message does not have the layout its channel declares")
        rows = np.empty((len(data), 1 + width))
        for start, column, count in self.spans:
            if count:
                rows[:, column : column + count] = data[:, start : start + 8 * count].view("<f8")
            else:
                rows[:, column] = data[:, start]
        return rows


def message_record(channel_id: int, message: bytes, sequence: int = 0, stamp_ns: int = 0) -> bytes:
    """The MCAP record of a message.

    Args:
        channel_id: the channel.
        message: its bytes.
        sequence: its number in the channel.
        stamp_ns: its time [ns].
    """
    header = Opcode.MESSAGE, _COUNTED_HEADER + len(message), channel_id, sequence, stamp_ns, stamp_ns
    return np.array(header, MESSAGE_HEADER).tobytes() + message


@lru_cache(_MOST_KEPT)
def channel_layout(channel: Channel) -> Layout:
    """Lay out the message of a channel: ``t`` is field 1, the channel's fields are 2, 3, ... in order."""
    message, spans = _laid_out(parts_of(channel), 2)
    return _layout(double_tag(1) + bytes(8) + message, [(1, 0, 1), *_shifted(spans, 9)])


def packed_layout(channel: Channel) -> Layout:
    """The same as formats 1 and 2 had it: a double, or packed ``repeated double`` without names."""
    message, spans = b"", []
    for number, (field, columns) in enumerate(zip(channel.fields, channel.columns, strict=True), start=2):
        message += double_tag(number) if field.width == 1 else length_prefix(number, 8 * field.width)
        spans.append((len(message), columns.start, field.width))
        message += bytes(8 * field.width)
    return _layout(double_tag(1) + bytes(8) + message, [(1, 0, 1), *_shifted(spans, 9)])


def _laid_out(parts: Sequence[Part], first: int) -> tuple[bytes, list[Span]]:
    """A message with zero numbers and where they lie, its fields numbered from one on."""
    message, spans = b"", []
    for number, part in enumerate(parts, start=first):
        if isinstance(part, Group):
            for element in part.elements:
                inner, within = _laid_out(element, 1)
                message += length_prefix(number, len(inner))
                spans += _shifted(within, len(message))
                message += inner
        elif isinstance(part, Code):
            message += tag(number, _VARINT)
            spans.append((len(message), part.column, 0))
            message += bytes(1)
        else:
            count = part.width if isinstance(part, Numbers) else 1
            message += length_prefix(number, 8 * count) if isinstance(part, Numbers) else double_tag(number)
            spans.append((len(message), part.column, count))
            message += bytes(8 * count)
    return message, spans


def _shifted(spans: Sequence[Span], by: int) -> list[Span]:
    return [(start + by, column, count) for start, column, count in spans]


def _layout(message: bytes, spans: Sequence[Span]) -> Layout:
    constant = np.ones(len(message), dtype=bool)
    for start, _, count in spans:
        constant[start : start + (8 * count or 1)] = False
    return Layout(np.frombuffer(message, np.uint8), tuple(spans), constant)
