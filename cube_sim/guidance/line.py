"""A straight path."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.path import PathPoint
from cube_sim.spatial import cross


class Line:
    """The segment from `start` to `end`, both (3,) [m], world axes.

    Raises:
        ValueError: the two points coincide.
    """

    def __init__(self, start: ArrayLike, end: ArrayLike) -> None:
        self._start = np.asarray(start, dtype=float)
        step = np.asarray(end, dtype=float) - self._start
        self.length = float(np.linalg.norm(step))
        if not self.length > 0.0:
            raise ValueError("a line needs two different points")
        tangent = step / self.length
        # Any normal will do; the axis least aligned with the tangent gives the best conditioned one.
        axis = np.eye(3)[int(np.argmin(np.abs(tangent)))]
        normal = axis - tangent * (axis @ tangent)
        normal /= np.linalg.norm(normal)
        self._rotation = np.column_stack([tangent, normal, cross(tangent, normal)])

    def at(self, s: float) -> PathPoint:
        """The line at arc length s [m]."""
        along = min(max(s, 0.0), self.length)
        return PathPoint(self._start + along * self._rotation[:, 0], self._rotation, (0.0, 0.0))
