"""A single point: the path of a vehicle that is to stay where it is."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.frame import starting_frame
from cube_sim.guidance.path import PathPoint


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
        rotation = starting_frame(np.array([cos(heading), sin(heading), 0.0]))
        self._point = PathPoint(np.array(position, dtype=float), rotation, (0.0, 0.0), (0.0, 0.0))

    def at(self, s: float) -> PathPoint:
        """The same point for every s."""
        return self._point
