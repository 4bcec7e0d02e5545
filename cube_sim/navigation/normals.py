"""Standard normal numbers drawn ahead: compiled laws take them in order, each sensor from a stream of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.navigation.imu import IMU_NORMALS
from cube_sim.spatial import Matrix

TICKS_AHEAD = 50
"""Ticks for which numbers are drawn at once: for fewer the drawing takes longer than the laws."""


class Normals(NamedTuple):
    """Numbers to be taken.

    Attributes:
        values: a row for each stream, the inertial unit's first (1 + k, n).
        used: how many of each row are taken (1 + k,).
    """

    values: Matrix
    used: NDArray[np.int64]


class DrawnAhead:
    """The streams of one vehicle's sensors, ahead of what has been taken from them.

    The numbers of a stream are those of one call after the other: how far ahead they are drawn changes none.

    Args:
        streams: the inertial unit's, then those of the k other sensors.

    Attributes:
        normals: what compiled laws take from.
    """

    def __init__(self, streams: Sequence[np.random.Generator]) -> None:
        self._streams = tuple(streams)
        self._ticks = 0
        n = len(self._streams)
        self.normals = Normals(np.empty((n, 0)), np.zeros(n, np.int64))

    def reserve(self, ticks: int) -> None:
        """Have enough for so many ticks, and count them as flown."""
        if self._ticks < ticks:
            self._draw(max(ticks, TICKS_AHEAD))
        self._ticks -= ticks

    def _draw(self, ticks: int) -> None:
        values, used = self.normals
        size = max(IMU_NORMALS * ticks, values.shape[1])  # no other sensor takes as many; what is left has room
        rows = []
        for row, taken, stream in zip(values, used.tolist(), self._streams, strict=True):
            left = row[taken:]
            rows.append(np.concatenate([left, stream.standard_normal(size - len(left))]))
        self.normals = Normals(np.array(rows), np.zeros_like(used))
        self._ticks = size // IMU_NORMALS
