"""A straight path."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import PathError
from cube_sim.guidance.frame import starting_frame
from cube_sim.guidance.path import PathPoint


class Line:
    """The segment from `start` to `end`, both (3,) [m], world axes.

    Raises:
        PathError: the two points coincide.
    """

    closed = False

    def __init__(self, start: ArrayLike, end: ArrayLike) -> None:
        self._start = np.asarray(start, dtype=float)
        step = np.asarray(end, dtype=float) - self._start
        self.length = float(np.linalg.norm(step))
        if not self.length > 0.0:
            raise PathError("a line needs two different points")
        self.edges = (0.0, self.length)
        self._rotation = starting_frame(step / self.length)

    def at(self, s: float) -> PathPoint:
        """The line at arc length s [m]."""
        along = min(max(s, 0.0), self.length)
        position = self._start + along * self._rotation[:, 0]
        return PathPoint(position, self._rotation, (0.0, 0.0), (0.0, 0.0))
