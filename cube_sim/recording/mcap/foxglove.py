"""Messages of the public foxglove schemas, so that any viewer shows the vehicle and the log."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.mcap.fixed_width import Layout, double_tag, length_prefix, tag, varint
from cube_sim.recording.mcap.schemas import LOG_LEVELS

WORLD_FRAME = "world"

_VARINT, _FIXED_VARINT = 0, 5


class FrameTransformLayout:
    """The pose of the vehicle as ``foxglove.FrameTransform``, constant in length.

    Protobuf varints may be padded with continuation bytes; every reader accepts them. Seconds and nanoseconds
    are therefore written in five bytes each (35 bits, good until the year 3058), whatever their value.
    """

    def __init__(self, vehicle: str) -> None:
        vector = b"".join(double_tag(i) + bytes(8) for i in (1, 2, 3))
        rotation = vector + double_tag(4) + bytes(8)
        stamp = tag(1, _VARINT) + bytes(_FIXED_VARINT) + tag(2, _VARINT) + bytes(_FIXED_VARINT)
        head = length_prefix(1, len(stamp))
        parts = (
            head + stamp,
            _text(2, WORLD_FRAME) + _text(3, vehicle),
            length_prefix(4, len(vector)) + vector,
            length_prefix(5, len(rotation)) + rotation,
        )
        message = b"".join(parts)
        self._seconds = len(head) + 1
        self._nanoseconds = self._seconds + _FIXED_VARINT + 1
        first_translation = len(parts[0] + parts[1] + length_prefix(4, len(vector))) + 1
        first_rotation = len(message) - len(rotation) + 1
        # Rows hold t, position xyz, quaternion wxyz; the message wants xyzw.
        spans = [(first_translation + 9 * i, 1 + i, 1) for i in range(3)]
        spans += [(first_rotation + 9 * i, column, 1) for i, column in enumerate((5, 6, 7, 4))]
        constant = np.zeros(len(message), dtype=bool)
        self._layout = Layout(np.frombuffer(message, np.uint8), tuple(spans), constant)
        self.length = len(message)

    def write(self, poses: NDArray[np.float64], stamps_ns: NDArray[np.uint64], out: NDArray[np.uint8]) -> None:
        """Encode poses.

        Args:
            poses: (n, 8), time [s], position [m], quaternion wxyz.
            stamps_ns: (n,) time of each since the epoch [ns].
            out: (n, length) uint8, filled.
        """
        self._layout.write(poses, out)
        seconds, nanoseconds = np.divmod(stamps_ns, np.uint64(1_000_000_000))
        out[:, self._seconds : self._seconds + _FIXED_VARINT] = _padded_varints(seconds)
        out[:, self._nanoseconds : self._nanoseconds + _FIXED_VARINT] = _padded_varints(nanoseconds)


def log_message(stamp_ns: int, level: str, text: str, name: str) -> bytes:
    """Encode one ``foxglove.Log``.

    Args:
        stamp_ns: time since the epoch [ns].
        level: one of ``LOG_LEVELS``.
        text: the message.
        name: who speaks.
    """
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    stamp = tag(1, _VARINT) + varint(seconds) + tag(2, _VARINT) + varint(nanoseconds)
    return (
        length_prefix(1, len(stamp))
        + stamp
        + tag(2, _VARINT)
        + varint(LOG_LEVELS.index(level))
        + _text(3, text)
        + _text(4, name)
    )


def _text(number: int, text: str) -> bytes:
    data = text.encode()
    return length_prefix(number, len(data)) + data


def _padded_varints(values: NDArray[np.uint64]) -> NDArray[np.uint8]:
    """Encode (n,) integers below 2^35 as (n, 5) bytes."""
    shifts = np.arange(0, 7 * _FIXED_VARINT, 7, dtype=np.uint64)
    groups = (values[:, None] >> shifts & np.uint64(0x7F)).astype(np.uint8)
    groups[:, :-1] |= 0x80
    return groups
