"""A circular helix about a vertical axis."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.guidance.path import PathPoint
from cube_sim.spatial import cross


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
        self._centre = np.asarray(centre, dtype=float)
        self._radius = radius
        self._rise = pitch / (2.0 * pi)
        self._start_angle = start_angle
        self._sense = -1.0 if clockwise else 1.0
        self._metre_per_radian = hypot(radius, self._rise)
        self._kappa = radius / self._metre_per_radian**2
        self._tau = self._sense * self._rise / self._metre_per_radian**2
        self.length = 2.0 * pi * turns * self._metre_per_radian
        self.edges = (0.0, self.length)

    def at(self, s: float) -> PathPoint:
        """The helix at arc length s [m]."""
        along = min(max(s, 0.0), self.length)
        turned = along / self._metre_per_radian
        angle = self._start_angle + self._sense * turned
        c, sn = cos(angle), sin(angle)
        R, b, l, sense = self._radius, self._rise, self._metre_per_radian, self._sense  # noqa: E741
        position = self._centre + np.array([R * c, R * sn, b * turned])
        tangent = np.array([-sense * R * sn / l, sense * R * c / l, b / l])
        normal = np.array([-c, -sn, 0.0])
        binormal = cross(tangent, normal)
        back = self._tau * along
        cb, sb = cos(back), sin(back)
        rotation = np.column_stack([tangent, cb * normal - sb * binormal, sb * normal + cb * binormal])
        bending, twisting = self._kappa, self._kappa * self._tau
        return PathPoint(position, rotation, (bending * cb, bending * sb), (-twisting * sb, twisting * cb))
