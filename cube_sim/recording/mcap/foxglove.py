"""Messages of the public foxglove schemas, so that any viewer shows the vehicle and the log."""

from __future__ import annotations

import numpy as np

from cube_sim.recording.mcap.fixed_width import Layout, double_tag, length_prefix, tag, varint
from cube_sim.recording.mcap.schemas import LOG_LEVELS

WORLD_FRAME = "world"

_VARINT, _FIXED_VARINT = 0, 5


def frame_transform_layout(vehicle: str) -> tuple[Layout, int]:
    """The pose of a vehicle as ``foxglove.FrameTransform``, constant in length.

    Protobuf varints may be padded with continuation bytes; every reader accepts them. Seconds and nanoseconds
    are therefore written in five bytes each (35 bits, good until the year 3058), whatever their value.

    Args:
        vehicle: its name.

    Returns:
        The layout of rows of the pose, and where in it the seconds are written; the nanoseconds follow six bytes on.
    """
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
    first_translation = len(parts[0] + parts[1] + length_prefix(4, len(vector))) + 1
    first_rotation = len(message) - len(rotation) + 1
    # Rows hold t, position xyz, quaternion wxyz; the message wants xyzw.
    spans = [(first_translation + 9 * i, 1 + i, 1) for i in range(3)]
    spans += [(first_rotation + 9 * i, column, 1) for i, column in enumerate((5, 6, 7, 4))]
    constant = np.zeros(len(message), dtype=bool)
    return Layout(np.frombuffer(message, np.uint8), tuple(spans), constant), len(head) + 1


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
