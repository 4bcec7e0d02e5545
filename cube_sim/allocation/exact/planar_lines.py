"""The lines of the planar search: in the plane of the free forces, each end of each side is one."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.native.compiled import bits, inlined
from cube_sim.wrench.tolerances import CROSSING, PARALLEL

WHICH = 255
"""Bits of a line's key that say which line it is. The others are its distance's, up to a part of 1e-13. In a plane
there are 48 lines at most, six for each of eight thrusters."""


class PlaneForces(NamedTuple):
    """Each thruster's force in the plane, counted from the point o: ``nearest + slope0 y0 + slope1 y1``.

    Attributes:
        nearest: (m,) force at o [N], allowed or not.
        length: (m,) of the slope.
        slope0: (m,) change of force along the first axis of the plane.
        slope1: (m,) along the second.
        low0: (m,) lower end of the negative side [N]; this and the five others widened by what counts as rounding.
        low1: (m,) lower end of rest [N].
        low2: (m,) lower end of the positive side [N].
        high0: (m,) upper end of the negative side [N].
        high1: (m,) upper end of rest [N].
        high2: (m,) upper end of the positive side [N].
    """

    nearest: NDArray[np.float64]
    length: NDArray[np.float64]
    slope0: NDArray[np.float64]
    slope1: NDArray[np.float64]
    low0: NDArray[np.float64]
    low1: NDArray[np.float64]
    low2: NDArray[np.float64]
    high0: NDArray[np.float64]
    high1: NDArray[np.float64]
    high2: NDArray[np.float64]


class Lines(NamedTuple):
    """Lines on which a thruster's force is at an end of a side. `take_nearest` brings the nearest to the front.

    Attributes:
        distance: (6 m,) signed distance from o along the thruster's slope.
        end: (6 m,) the force on the line [N].
        penalty: (6 m,) of the side [N^2].
        normal0: (6 m,) unit normal along the first axis of the plane, of lines taken.
        normal1: (6 m,) along the second.
        thruster: (6 m,) whose line it is.
        inward: (6 m,) where its interval lies: +1 above a lower end, -1 below an upper end, 0 on both sides.
        key: (6 m,) orders the lines by distance, and says which one it is.
    """

    distance: NDArray[np.float64]
    end: NDArray[np.float64]
    penalty: NDArray[np.float64]
    normal0: NDArray[np.float64]
    normal1: NDArray[np.float64]
    thruster: NDArray[np.int64]
    inward: NDArray[np.int64]
    key: NDArray[np.int64]


def suits_planar_search(plane: NDArray[np.float64]) -> bool:
    """Whether every two lines are clearly parallel or clearly crossing, so that no intersection is rounding.

    Args:
        plane: (m, 2) see `planar_search`.
    """
    length = np.linalg.norm(plane, axis=1)
    unit = plane[length > PARALLEL] / length[length > PARALLEL, None]
    sine = np.abs(np.outer(unit[:, 0], unit[:, 1]) - np.outer(unit[:, 1], unit[:, 0]))
    return not np.any((sine > PARALLEL) & (sine < CROSSING))


@inlined
def closest_to_target(
    origin: NDArray[np.float64],
    plane: NDArray[np.float64],
    intervals: SideIntervals,
    side_cost: SideCost,
    tolerance: float,
    forces: PlaneForces,
) -> tuple[float, bool]:
    """Find the point o; return its cost [N^2], and whether the thrusters that no z moves are on allowed sides there."""
    low, high = intervals.low, intervals.high
    z0, z1 = 0.0, 0.0
    for i in range(origin.shape[0]):
        forces.slope0[i], forces.slope1[i] = plane[i, 0], plane[i, 1]
        forces.low0[i], forces.low1[i], forces.low2[i] = (
            low[i, 0] - tolerance,
            low[i, 1] - tolerance,
            low[i, 2] - tolerance,
        )
        forces.high0[i], forces.high1[i], forces.high2[i] = (
            high[i, 0] + tolerance,
            high[i, 1] + tolerance,
            high[i, 2] + tolerance,
        )
        weighted = side_cost.weight[i] * (side_cost.target[i, 0] - origin[i])
        z0 += plane[i, 0] * weighted
        z1 += plane[i, 1] * weighted
    cost_at_o, allowed = 0.0, True
    for i in range(origin.shape[0]):
        force = origin[i] + plane[i, 0] * z0 + plane[i, 1] * z1
        cost_at_o += side_cost.weight[i] * (force - side_cost.target[i, 0]) ** 2
        forces.nearest[i], forces.length[i] = force, math.sqrt(plane[i, 0] ** 2 + plane[i, 1] ** 2)
        if forces.length[i] <= PARALLEL:
            inside = False
            for s in range(3):
                inside = inside or (low[i, s] - tolerance <= force and force <= high[i, s] + tolerance)
            allowed = allowed and inside
    return cost_at_o, allowed


@inlined
def draw_lines(intervals: SideIntervals, penalty: NDArray[np.float64], forces: PlaneForces, lines: Lines) -> int:
    """Write a line for each end of each open side; return their number. Ends that two sides share make one line."""
    count = 0
    for i in range(penalty.shape[0]):
        if forces.length[i] <= PARALLEL:
            continue
        for s in range(3):
            if intervals.masks[i] >> s & 1:
                for upper in range(2):
                    end = intervals.high[i, s] if upper else intervals.low[i, s]
                    last = count - 1
                    if count > 0 and lines.thruster[last] == i and lines.end[last] == end:
                        lines.inward[last] = 0  # sides touch, or rest, which is a point: the interval has no inside
                        lines.penalty[last] = min(lines.penalty[last], penalty[i, s])
                        continue
                    lines.thruster[count], lines.end[count], lines.inward[count] = i, end, 1 - 2 * upper
                    lines.penalty[count] = penalty[i, s]
                    lines.distance[count] = (end - forces.nearest[i]) / forces.length[i]
                    lines.key[count] = bits(abs(lines.distance[count])) & ~WHICH | count
                    count += 1
    return count


@inlined
def take_nearest(lines: Lines, count: int, p: int, forces: PlaneForces) -> None:
    """Exchange line p with the nearest of those from p on. The least key is found without a branch."""
    rest = lines.key[p:count]
    lowest = rest[0]
    for other in range(rest.shape[0]):
        lowest = min(lowest, rest[other])
    nearest = lowest & WHICH
    lines.key[nearest] = lines.key[p] & ~WHICH | nearest
    lines.distance[p], lines.distance[nearest] = lines.distance[nearest], lines.distance[p]
    lines.end[p], lines.end[nearest] = lines.end[nearest], lines.end[p]
    lines.penalty[p], lines.penalty[nearest] = lines.penalty[nearest], lines.penalty[p]
    lines.thruster[p], lines.thruster[nearest] = lines.thruster[nearest], lines.thruster[p]
    lines.inward[p], lines.inward[nearest] = lines.inward[nearest], lines.inward[p]
    i = lines.thruster[p]
    lines.normal0[p], lines.normal1[p] = forces.slope0[i] / forces.length[i], forces.slope1[i] / forces.length[i]
