"""Rows of all channels to the records of one MCAP chunk, in the order of time: compiled, without Python's lock.

A record is a template in which only the sequence number, the times and the numbers differ (`fixed_width`). Log lines
differ in length: their records come ready made.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from cube_sim.native.byte_arrays import copy_bytes, put_integer
from cube_sim.native.compiled import compiled, unlocked
from cube_sim.recording.mcap.fixed_width import MESSAGE_HEADER
from cube_sim.recording.mcap.names import EPOCH_NS

STREAM = np.dtype(
    [
        (name, np.int64)
        for name in (
            "channel_id",
            "template",  # where its record starts among the templates; -1 for records that come ready made
            "length",  # bytes of a record
            "span",  # the first of its spans
            "span_end",
            "seconds",  # where in the record a stamp's seconds are written in five bytes, nanoseconds after; or -1
            "row",  # where its first row starts among the numbers; ready made: where its first time stands
            "width",  # numbers per row, the time first
            "count",  # rows
            "sequence",  # number of the first
        )
    ]
)
"""One channel's part of a chunk."""

_MESSAGE_INDEX = int(Opcode.MESSAGE_INDEX)
_SEQUENCE, _TIMES, INDEX_HEAD, INDEX_ENTRY = 11, 15, 15, 16
assert MESSAGE_HEADER.fields is not None
assert MESSAGE_HEADER.fields["sequence"][1] == _SEQUENCE
assert MESSAGE_HEADER.fields["log_time"][1] == _TIMES


class Templates(NamedTuple):
    """What is the same in every chunk.

    Attributes:
        records: bytes of one record of each channel.
        spans: (k, 3) for each run of adjacent numbers: first byte in the record, first column, number of columns; 0 for
            a code, which is one byte.
    """

    records: NDArray[np.uint8]
    spans: NDArray[np.int64]


class ReadyMade(NamedTuple):
    """Records of one channel that differ in length.

    Attributes:
        records: their bytes, one after another.
        ends: (n,) where each ends.
    """

    records: NDArray[np.uint8]
    ends: NDArray[np.int64]


@compiled
def put_padded(out, at, value):
    """Write an integer below 2^35 as a protobuf varint of five bytes, at one place of the bytes `out`."""
    for i in range(5):
        out[at + i] = ((value >> (7 * i)) & 0x7F) | (0x80 if i < 4 else 0)


@compiled
def stamp_of(t):
    """Time stamp [ns] of a simulated time t [s]."""
    return EPOCH_NS + np.int64(np.rint(t * 1e9))


@compiled
def put_record(out, at, stream, templates, k, stamp, rows, numbers):
    """Write the k-th record of a channel.

    Args:
        out: bytes, filled.
        at: where in it.
        stream: the channel's `STREAM`.
        templates: `Templates`.
        k: which of its rows.
        stamp: [ns].
        rows: all rows, as numbers.
        numbers: the same as bytes.

    Returns:
        Whether its codes are whole numbers from 0 to 127, and so fit into their bytes.
    """
    copy_bytes(out, at, templates.records, stream.template, stream.length)
    put_integer(out, at + _SEQUENCE, np.uint32(stream.sequence + k))
    put_integer(out, at + _TIMES, stamp)
    put_integer(out, at + _TIMES + 8, stamp)
    if stream.seconds >= 0:
        put_padded(out, at + stream.seconds, stamp // 1_000_000_000)
        put_padded(out, at + stream.seconds + 6, stamp % 1_000_000_000)
    row, fits = stream.row + k * stream.width, True
    for j in range(stream.span, stream.span_end):
        start, column, count = templates.spans[j]
        if count:
            copy_bytes(out, at + start, numbers, 8 * (row + column), 8 * count)
        else:
            code = rows[row + column]
            fits &= code >= 0.0 and code <= 127.0 and code == np.floor(code)  # a NaN does not fit
            out[at + start] = np.uint8(code) if fits else 0
    return fits


@unlocked
def encode(streams, templates, times, numbers, ready, ahead, out, index):
    """Write the records of a chunk and their message index.

    Args:
        streams: `STREAM` of the channels that have any; those of one instant are written in this order.
        templates: `Templates`.
        times: all rows one after another, as numbers; behind them the times of the ready-made records.
        numbers: the same as bytes.
        ready: `ReadyMade`.
        ahead: bytes of the chunk before the first record.
        out: bytes of the chunk, filled from there on.
        index: bytes of the message index records of all streams, filled.

    Returns:
        The first and the last time stamp, and whether every code fits into its byte.
    """
    n, at = len(streams), ahead
    done, entries = np.zeros(n, np.int64), np.empty(n, np.int64)
    place = 0
    for s in range(n):
        size = INDEX_ENTRY * streams[s].count
        index[place] = _MESSAGE_INDEX
        put_integer(index, place + 1, 6 + size)
        put_integer(index, place + 9, np.uint16(streams[s].channel_id))
        put_integer(index, place + 11, np.uint32(size))
        entries[s] = place + INDEX_HEAD
        place += INDEX_HEAD + size
    first, last, fit = stamp_of(times[streams[0].row]), np.int64(0), True
    while True:
        now = inf
        for s in range(n):
            if done[s] < streams[s].count:
                now = min(now, times[streams[s].row + done[s] * streams[s].width])
        if now == inf:
            return first, last, fit
        stamp = stamp_of(now)
        first, last = min(first, stamp), max(last, stamp)
        for s in range(n):
            stream = streams[s]
            while done[s] < stream.count and stamp_of(times[stream.row + done[s] * stream.width]) == stamp:
                k = done[s]
                put_integer(index, entries[s], stamp)
                put_integer(index, entries[s] + 8, at)
                entries[s] += INDEX_ENTRY
                if stream.template >= 0:
                    fit &= put_record(out, at, stream, templates, k, stamp, times, numbers)
                    at += stream.length
                else:
                    start = ready.ends[k - 1] if k else 0
                    copy_bytes(out, at, ready.records, start, ready.ends[k] - start)
                    at += ready.ends[k] - start
                done[s] += 1
