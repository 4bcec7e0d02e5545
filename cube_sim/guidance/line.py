"""A straight path."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import PathError
from cube_sim.guidance.frame import starting_frame
from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.guidance.path_record import NO_TABLE, PATH, Parts, path_row


class Line:
    """The segment from `start` to `end`, both (3,) [m], world axes.

    Raises:
        PathError: the two points coincide.
    """

    closed = False

    def __init__(self, start: ArrayLike, end: ArrayLike) -> None:
        step = np.asarray(end, dtype=float) - np.asarray(start, dtype=float)
        self.length = float(np.linalg.norm(step))
        if not self.length > 0.0:
            raise PathError("a line needs two different points")
        self.edges = (0.0, self.length)
        rotation, record = starting_frame(step / self.length), np.zeros(1, PATH)
        record["length"], record["last"] = self.length, self.length
        record["constant"] = np.column_stack([start, rotation])
        record["straight"] = rotation[:, 0]
        self.parts: Parts = (record, *NO_TABLE)

    def at(self, s: float) -> PathPoint:
        """The line at arc length s [m]."""
        return point_of_row(path_row(*self.parts, s))
