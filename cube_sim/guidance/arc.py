"""Arcs of circles in any plane, and whole circles."""

from __future__ import annotations

from math import cos, inf, pi, sin

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import PathError
from cube_sim.guidance.frame import starting_frame
from cube_sim.guidance.path import PathPoint, point_of_row
from cube_sim.guidance.path_record import NO_TABLE, PATH, Parts, path_row
from cube_sim.spatial import Vector, cross

STRAIGHT = 1e-6
"""Sine of the angle between the chords of an arc below which its three points are taken to lie on a line."""


class Arc:
    """A circular arc with its parallel-transport frame in closed form.

    In a plane the normal that points to the centre and the axis are both parallel-transported, so the frame is those
    two, turned by the constant angle that makes it start as `starting_frame` says, and the curvatures are constant.

    Args:
        centre: (3,) [m], world axes.
        spoke: from the centre to the arc's first point (3,) [m], square to the axis.
        axis: unit vector (3,) about which the arc turns, right-handed.
        sweep: angle of the arc [rad], positive.
        closed: whether it is a whole circle, to be run round and round.
    """

    def __init__(self, centre: Vector, spoke: Vector, axis: Vector, sweep: float, closed: bool = False) -> None:
        self.closed = closed
        radius = float(np.linalg.norm(spoke))
        self.length = radius * sweep
        self.edges = (0.0, self.length)
        out = spoke / radius
        ahead = cross(axis, out)
        _, N1, N2 = starting_frame(ahead).T
        inward_1, inward_2, axial_1, axial_2 = -N1 @ out, -N2 @ out, N1 @ axis, N2 @ axis
        record, R = np.zeros(1, PATH), radius
        record["closed"], record["length"], record["angle_per_metre"] = closed, self.length, 1.0 / radius
        record["first"], record["last"] = (-inf, inf) if closed else (0.0, self.length)
        record["curvature"] = inward_1 / radius, inward_2 / radius
        # [p, T, N1, N2] as constant + cos * one + sin * other
        record["constant"] = np.column_stack([centre, np.zeros(3), axial_1 * axis, axial_2 * axis])
        record["cosine"] = np.column_stack([R * out, ahead, -inward_1 * out, -inward_2 * out])
        record["sine"] = np.column_stack([R * ahead, -out, -inward_1 * ahead, -inward_2 * ahead])
        self.parts: Parts = (record, *NO_TABLE)

    def at(self, s: float) -> PathPoint:
        """The arc at arc length s [m]."""
        return point_of_row(path_row(*self.parts, s))


def arc_through(start: ArrayLike, through: ArrayLike, end: ArrayLike) -> Arc:
    """The arc from `start` over `through` to `end`, each (3,) [m], world axes.

    Raises:
        PathError: two points coincide or all lie on a line.
    """
    a, b, c = (np.asarray(point, dtype=float) for point in (start, through, end))
    for point, (p, q) in (("through_m", (a, b)), ("end_m", (b, c)), ("end_m", (c, a))):
        if np.array_equal(p, q):
            raise PathError("an arc needs three different points", point)
    ab, ac = b - a, c - a
    normal = cross(ab, ac)
    area = float(np.linalg.norm(normal))
    if area <= STRAIGHT * float(np.linalg.norm(ab) * np.linalg.norm(ac)):
        raise PathError("the three points of the arc lie on a line", "through_m")
    # circumcentre of the triangle, from a
    to_centre = (cross(normal, ab) * (ac @ ac) + cross(ac, normal) * (ab @ ab)) / (2.0 * area**2)
    axis, spoke = normal / area, -to_centre
    last = ac - to_centre
    sweep = float(np.arctan2(last @ cross(axis, spoke), last @ spoke)) % (2.0 * pi)
    return Arc(a + to_centre, spoke, axis, sweep)


def circle(
    centre: ArrayLike,
    radius: float,
    axis: ArrayLike = (0.0, 0.0, 1.0),
    start_angle: float = 0.0,
    clockwise: bool = False,
) -> Arc:
    """A closed circle.

    Args:
        centre: (3,) [m], world axes.
        radius: [m].
        axis: (3,), square to the circle's plane, of any length but zero; "seen from above" is from its tip.
        start_angle: where it starts [rad]: about the axis, from world x laid into the plane (world y where the axis
            is world x).
        clockwise: whether it turns right, seen from above.

    Raises:
        PathError: the axis has no direction.
    """
    up = np.asarray(axis, dtype=float)
    size = float(np.linalg.norm(up))
    if not size > 0.0:
        raise PathError("the axis of a circle needs a direction", "axis")
    up = up / size
    zero = np.array([1.0, 0.0, 0.0]) - up * up[0]
    if zero @ zero < 1e-12:
        zero = np.array([0.0, 1.0, 0.0]) - up * up[1]
    zero /= np.linalg.norm(zero)
    spoke = radius * (cos(start_angle) * zero + sin(start_angle) * cross(up, zero))
    return Arc(np.asarray(centre, dtype=float), spoke, -up if clockwise else up, 2.0 * pi, closed=True)
