"""A single point: the path of a vehicle that is to stay where it is."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.frame import starting_frame
from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.guidance.path_record import NO_TABLE, PATH, Parts, path_row


class Point:
    """A path of length 0, whose tangent says which way is ahead.

    Args:
        position: (3,) [m], world axes.
        heading: direction of the level tangent, from world x towards world y [rad].
    """

    closed = False
    length = 0.0
    edges = (0.0, 0.0)

    def __init__(self, position: ArrayLike, heading: float) -> None:
        rotation, record = starting_frame(np.array([cos(heading), sin(heading), 0.0])), np.zeros(1, PATH)
        record["constant"] = np.column_stack([np.array(position, dtype=float), rotation])
        self.parts: Parts = (record, *NO_TABLE)

    def at(self, s: float) -> PathPoint:
        """The same point for every s."""
        return point_of_row(path_row(*self.parts, s))
