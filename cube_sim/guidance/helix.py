"""A circular helix about a vertical axis."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.guidance.path_record import HELIX, NO_TABLE, PATH, Parts, path_row


class Helix:
    """A helix with its parallel-transport frame in closed form.

    Frenet's curvature and torsion are constant, kappa = R / l^2 and tau = b / l^2 with b the rise per radian and
    l = sqrt(R^2 + b^2). Turning Frenet's normals back by the angle tau s about the tangent removes their spin, so
    k1 = kappa cos(tau s) and k2 = kappa sin(tau s).

    Args:
        centre: (3,) [m], the point of the axis at the height where the helix starts, world axes.
        radius: R [m].
        pitch: rise per turn [m]; negative descends.
        turns: number of turns.
        start_angle: from world x towards world y [rad].
        clockwise: whether it turns right, seen from above.
    """

    closed = False

    def __init__(
        self,
        centre: ArrayLike,
        radius: float,
        pitch: float,
        turns: float,
        start_angle: float = 0.0,
        clockwise: bool = False,
    ) -> None:
        rise, sense = pitch / (2.0 * pi), -1.0 if clockwise else 1.0
        square = radius**2 + rise**2
        self.length = 2.0 * pi * turns * sqrt(square)
        record = np.zeros(1, PATH)
        record["kind"], record["length"], record["last"] = HELIX, self.length, self.length
        record["centre"] = centre
        record["helix"] = radius, rise, sense, start_angle, radius / square, sense * rise / square
        self.parts: Parts = (record, *NO_TABLE)
        self.edges = (0.0, self.length)

    def at(self, s: float) -> PathPoint:
        """The helix at arc length s [m]."""
        return point_of_row(path_row(*self.parts, s))
