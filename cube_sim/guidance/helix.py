"""A circular helix about a vertical axis."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples


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
        numbers = radius, rise, sense, start_angle, radius / square, sense * rise / square
        self._numbers = np.array(centre, dtype=float), *(float(number) for number in numbers)
        self.length = 2.0 * pi * turns * sqrt(square)
        self.edges = (0.0, self.length)

    def at(self, s: float) -> PathPoint:
        """The helix at arc length s [m]."""
        along = min(max(s, 0.0), self.length)
        return point_of_row(helix_point(*self._numbers, along))


@compiled
def helix_point(centre, radius, rise, sense, start_angle, kappa, tau, along):
    """The helix at one arc length, a row (16,) as `point_of_row` takes it.

    Args:
        centre: (3,) [m].
        radius: R [m].
        rise: b [m].
        sense: 1 to the left, -1 to the right.
        start_angle: [rad].
        kappa: curvature [1/m].
        tau: torsion [1/m].
        along: arc length [m].
    """
    metre_per_radian = sqrt(radius * radius + rise * rise)
    turned = along / metre_per_radian
    angle = start_angle + sense * turned
    c, s = cos(angle), sin(angle)
    across, up = sense * radius / metre_per_radian, rise / metre_per_radian
    T, normal = (-across * s, across * c, up), (-c, -s, 0.0)
    binormal = cross_tuples(T, normal)
    back = tau * along
    cb, sb = cos(back), sin(back)
    row = np.empty(16)
    row[0], row[1], row[2] = centre[0] + radius * c, centre[1] + radius * s, centre[2] + rise * turned
    for i in range(3):
        row[3 + 3 * i] = T[i]
        row[4 + 3 * i] = cb * normal[i] - sb * binormal[i]
        row[5 + 3 * i] = sb * normal[i] + cb * binormal[i]
    row[12], row[13], row[14], row[15] = kappa * cb, kappa * sb, -kappa * tau * sb, kappa * tau * cb
    return row
