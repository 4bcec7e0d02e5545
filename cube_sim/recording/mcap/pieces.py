"""Protobuf messages put together of pieces that know where their changing numbers lie."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.mcap.fixed_width import Layout, double_tag, length_prefix, tag, varint

_VARINT = 0

Numbers = Sequence[float] | NDArray[np.float64]


class Fragment(NamedTuple):
    """Some bytes of a message.

    Attributes:
        data: the bytes; changing numbers are zero.
        slots: first byte of each changing number, in the order in which a row has them.
    """

    data: bytes
    slots: tuple[int, ...] = ()


def together(pieces: Iterable[Fragment]) -> Fragment:
    """Pieces one after another."""
    data, slots = bytearray(), []
    for piece in pieces:
        slots += [len(data) + slot for slot in piece.slots]
        data += piece.data
    return Fragment(bytes(data), tuple(slots))


def message(number: int, *pieces: Fragment) -> Fragment:
    """A field that is a message of these pieces."""
    inside = together(pieces)
    return together((Fragment(length_prefix(number, len(inside.data))), inside))


def double(number: int, value: float | None) -> Fragment:
    """A number; None for one that changes."""
    data = double_tag(number) + np.array(value or 0.0, "<f8").tobytes()
    return Fragment(data, (len(data) - 8,) if value is None else ())


def doubles(values: Numbers | None, count: int) -> Fragment:
    """Numbers in the fields 1, 2 ...; None for as many that change."""
    return together(double(i + 1, None if values is None else float(values[i])) for i in range(count))


def text(number: int, value: str) -> Fragment:
    """A string."""
    data = value.encode()
    return Fragment(length_prefix(number, len(data)) + data)


def integer(number: int, value: int) -> Fragment:
    """An integer that is not negative, an enumeration or a truth value."""
    return Fragment(tag(number, _VARINT) + varint(value))


def packed_fixed32(number: int, values: Sequence[int] | NDArray[np.int32]) -> Fragment:
    """A list of integers of 32 bits."""
    data = np.asarray(values, "<u4").tobytes()
    return Fragment(length_prefix(number, len(data)) + data)


def layout_of(piece: Fragment, columns: Sequence[int]) -> Layout:
    """Where the numbers of a row are written.

    Args:
        piece: the message.
        columns: of each changing number the column of a row, the time being column 0.
    """
    spans = tuple((slot, column, 1) for slot, column in zip(piece.slots, columns, strict=True))
    template = np.frombuffer(piece.data, np.uint8)
    return Layout(template, spans, np.zeros(len(template), bool))
