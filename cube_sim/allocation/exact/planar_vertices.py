"""The exact search where the forces have at most two degrees of freedom left: every possible optimum, one by one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.planar_lines import (
    Lines,
    PlaneForces,
    closest_to_target,
    draw_lines,
    take_nearest,
)
from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.allocation.exact.ties import tie_tolerance
from cube_sim.allocation.exact.workspace import Workspace
from cube_sim.native.compiled import compiled, inlined
from cube_sim.wrench.tolerances import CROSSING, PARALLEL

SINE = math.sqrt(PARALLEL * CROSSING)
"""Tells the two apart."""


@inlined
def candidate(lines: Lines, p: int, q: int, most: float) -> tuple[bool, float, float, float, float]:
    """One row of the table of `planar_search`.

    Args:
        lines: p and q taken.
        p: see `planar_search`.
        q: likewise.
        most: largest square of the distance from the foot on line p, penalties of q included [N^2].

    Returns:
        Whether the point is a candidate; its distance from the foot on line p, along it; its coordinates from o; the
        sine of the lines' angle, 1 without q.
    """
    if p < 0:
        return True, 0.0, 0.0, 0.0, 1.0
    d = lines.distance[p]
    if q < 0:
        return not lines.inward[p] * d < 0.0, 0.0, d * lines.normal0[p], d * lines.normal1[p], 1.0
    sine = lines.normal0[p] * lines.normal1[q] - lines.normal1[p] * lines.normal0[q]
    cosine = lines.normal0[p] * lines.normal0[q] + lines.normal1[p] * lines.normal1[q]
    off = lines.distance[q] - cosine * d
    rounding = -1e-9 * (abs(d) + abs(lines.distance[q]))
    if (
        (abs(sine) <= SINE)
        | (off * off > (most - lines.penalty[q]) * sine * sine)
        | (lines.inward[q] * off < rounding)
        | (lines.inward[p] * (d - cosine * lines.distance[q]) < rounding)
    ):
        return False, 0.0, 0.0, 0.0, 1.0
    off /= sine
    y0, y1 = d * lines.normal0[p] - off * lines.normal1[p], d * lines.normal1[p] + off * lines.normal0[p]
    return True, off, y0, y1, sine


@inlined
def allowed_at(y0: float, y1: float, forces: PlaneForces) -> bool:
    """Whether every force lies on one of its sides; without a branch: a few instructions for all thrusters at once."""
    rounding = 1e-9 * (abs(y0) + abs(y1))  # what rounding may do to forces that are known to lie on their lines
    forbidden = 0
    for h in range(forces.nearest.shape[0]):
        force = forces.nearest[h] + forces.slope0[h] * y0 + forces.slope1[h] * y1
        under, over = force + rounding, force - rounding
        forbidden |= int(
            ((under < forces.low0[h]) | (over > forces.high0[h]))
            & ((under < forces.low1[h]) | (over > forces.high1[h]))
            & ((under < forces.low2[h]) | (over > forces.high2[h]))
        )
    return forbidden == 0


@inlined
def cheapest_sides(
    lines: Lines,
    p: int,
    q: int,
    y0: float,
    y1: float,
    intervals: SideIntervals,
    penalty: NDArray[np.float64],
    tolerance: float,
    forces: PlaneForces,
    chosen: NDArray[np.int64],
) -> float:
    """Write the cheapest side (m,) that holds each force; return the sum of their penalties, infinite where none does.

    Where sides touch and cost the same, off wins, then the side of the force's sign.
    """
    i, j = lines.thruster[p] if p >= 0 else -1, lines.thruster[q] if q >= 0 else -1
    first, second = lines.end[p] if p >= 0 else 0.0, lines.end[q] if q >= 0 else 0.0
    total = 0.0
    for h in range(forces.nearest.shape[0]):
        force = forces.nearest[h] + forces.slope0[h] * y0 + forces.slope1[h] * y1
        force = first if h == i else (second if h == j else force)
        side, least = 0, math.inf
        for turn in range(3):
            s = 1 if turn == 0 else (0 if (turn == 1) == (force < 0.0) else 2)
            inside = (intervals.low[h, s] - tolerance <= force) & (force <= intervals.high[h, s] + tolerance)
            if inside and penalty[h, s] < least:
                side, least = s, penalty[h, s]
        chosen[h] = side
        total += least
    return total


@inlined
def write_point(
    lines: Lines,
    p: int,
    q: int,
    y0: float,
    y1: float,
    sine: float,
    forces: PlaneForces,
    force: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> None:
    """Write a candidate's forces (m,) and multipliers (m,): its move from o in terms of the normals of its lines."""
    for h in range(force.shape[0]):
        force[h] = forces.nearest[h] + forces.slope0[h] * y0 + forces.slope1[h] * y1
        multiplier[h] = 0.0
    if p >= 0:
        i = lines.thruster[p]
        force[i], multiplier[i] = lines.end[p], -lines.distance[p] / forces.length[i]
        if q >= 0:
            j = lines.thruster[q]
            force[j] = lines.end[q]
            multiplier[j] = (y0 * lines.normal1[p] - y1 * lines.normal0[p]) / (sine * forces.length[j])
            multiplier[i] = (y1 * lines.normal0[q] - y0 * lines.normal1[q]) / (sine * forces.length[i])


@compiled
def planar_search(
    origin: NDArray[np.float64],
    plane: NDArray[np.float64],
    intervals: SideIntervals,
    side_cost: SideCost,
    previous: NDArray[np.float64],
    tolerance: float,
    workspace: Workspace,
    force: NDArray[np.float64],
    subset: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> tuple[bool, float, int]:
    """Minimise ``sum w (f - target)^2 + penalty`` over ``f = origin + plane z`` with every f_i on an allowed side.

    In the plane of z each end of each side is a line and each subset a convex polygon between lines. The cost is the
    squared distance from one point o plus the penalties::

                          /  line q
            ----.--------x---------------  line p: d away from o
                | d     /
                o      /                   . foot of the perpendicular    x intersection

    The optimum of a polygon is one of these points:

    ===  ===  ====================  ===================================================================
    p    q    point                 is a candidate
    ===  ===  ====================  ===================================================================
    -1   -1   o                     always
    >=0  -1   foot on line p        unless o lies inside of the interval that ends at p
    >=0  <p   intersection          if the lines cross, it is near enough to be better than the best so far, and the
                                    foot on each line lies outside of the interval that ends at the other one
    ===  ===  ====================  ===================================================================

    A point that could leave a line for the inside of its interval is no optimum of its polygon. So the cheapest
    candidate whose forces are allowed is the optimum over all subsets. Lines are taken nearest first: those farther
    away than the best so far need no look.

    Args:
        origin: (m,) any forces making the wrench [N].
        plane: (m, 2) null space with ``plane.T @ diag(w) @ plane = I``, columns of zeros for missing dimensions.
        intervals: open to the thrusters.
        side_cost: of the sides, with one preferred force for all sides of a thruster.
        previous: (m,) subset that ties prefer.
        tolerance: force that counts as rounding [N].
        workspace: scratch rows.
        force: (m,) out [N].
        subset: (m,) out: -1, 0, +1.
        multiplier: (m,) out: multipliers of the interval ends.

    Returns:
        Whether there is an answer, its cost [N^2], and the number of points looked at.
    """
    a, b, c, margin = workspace.planes, workspace.lines, workspace.counts, 2.0 * tolerance
    forces = PlaneForces(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9])
    lines, chosen = Lines(b[0], b[1], b[2], b[3], b[4], c[0], c[1], c[2]), c[3]
    cost_at_o, possible = closest_to_target(origin, plane, intervals, side_cost, margin, forces)
    if not possible:
        return False, math.inf, 0
    count = draw_lines(intervals, side_cost.penalty, forces, lines)
    best, value, changes_best, looked = math.inf, math.inf, 0, 0
    for p in range(-1, count):
        d, penalty = 0.0, 0.0
        if p >= 0:
            take_nearest(lines, count, p, forces)
            d, penalty = lines.distance[p], lines.penalty[p]
        bound = cost_at_o + d * d
        if bound > best + tie_tolerance(best):
            break
        if bound + penalty > best + tie_tolerance(best):
            continue
        for q in range(-1, max(p, 0)):
            there, off, y0, y1, sine = candidate(lines, p, q, best + tie_tolerance(best) - bound - penalty)
            if not there:
                continue
            looked += 1
            if not allowed_at(y0, y1, forces):
                continue
            penalties = cheapest_sides(lines, p, q, y0, y1, intervals, side_cost.penalty, margin, forces, chosen)
            cost = bound + off * off + penalties
            if penalties == math.inf or cost > best + tie_tolerance(best):
                continue
            changes, forward = 0, 0  # as `preferred` decides
            for h in range(origin.shape[0]):
                changes += chosen[h] - 1 != previous[h]
                if forward == 0 and best < math.inf:
                    forward = chosen[h] - 1 - int(subset[h])
            no_better = cost >= best - tie_tolerance(best)
            if no_better and (changes > changes_best or (changes == changes_best and forward <= 0)):
                continue
            best, value, changes_best = min(best, cost), cost, changes
            write_point(lines, p, q, y0, y1, sine, forces, force, multiplier)
            for h in range(origin.shape[0]):
                subset[h] = chosen[h] - 1.0
    return best < math.inf, value, looked
