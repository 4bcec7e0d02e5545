"""The exact search where the forces have at most two degrees of freedom left: every possible optimum, one by one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.relaxation import choose_side
from cube_sim.allocation.sides import Price, Sides
from cube_sim.allocation.ties import changed, preferred, slack_of
from cube_sim.compiled import compiled

PARALLEL, CROSSING = 1e-12, 1e-6
"""Two motors' lines in the plane count as parallel below the first sine and must cross above the second."""

SINE = math.sqrt(PARALLEL * CROSSING)
"""Tells the two apart."""


def suits_lines(plane: NDArray[np.float64]) -> bool:
    """Whether every two lines are clearly parallel or clearly crossing, so that no intersection is rounding.

    Args:
        plane: (m, 2) see `line_search`.
    """
    length = np.linalg.norm(plane, axis=1)
    unit = plane[length > PARALLEL] / length[length > PARALLEL, None]
    sine = np.abs(np.outer(unit[:, 0], unit[:, 1]) - np.outer(unit[:, 1], unit[:, 0]))
    return not np.any((sine > PARALLEL) & (sine < CROSSING))


@compiled
def line_search(
    origin: NDArray[np.float64],
    plane: NDArray[np.float64],
    sides: Sides,
    price: Price,
    previous: NDArray[np.float64],
    tolerance: float,
    force: NDArray[np.float64],
    subset: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> tuple[bool, float, int]:
    """Minimise ``sum w (f - target)^2 + penalty`` over ``f = origin + plane z`` with every f_i on an allowed side.

    In the plane of z each end of each side is a line, each subset a convex polygon between lines, and the cost is
    the squared distance from one point plus the penalties. The optimum of a polygon is that point, or the foot of
    its perpendicular on a line, or an intersection of two lines. So the cheapest of these that is allowed is the
    optimum over all subsets; those farther away than the best so far need no look.

    Args:
        origin: (m,) any forces making the wrench [N].
        plane: (m, 2) kernel with ``plane.T @ diag(w) @ plane = I``, columns of zeros for missing dimensions.
        sides: open to the motors.
        price: of them, with one preferred force for all sides of a motor.
        previous: (m,) subset that ties prefer.
        tolerance: force that counts as rounding [N].
        force: (m,) out [N].
        subset: (m,) out: -1, 0, +1.
        multiplier: (m,) out: multipliers of the interval ends.

    Returns:
        Whether there is an answer, its cost, and the number of points looked at.
    """
    m = origin.shape[0]
    masks, weight, target = sides.masks, price.weight, price.target
    near, length = np.empty(m), np.empty(m)  # forces closest to the target, allowed or not; of the motors' normals
    motor, end, away = np.empty(6 * m, np.int64), np.empty(6 * m), np.empty(6 * m)  # lines, the nearest first
    lines = 0
    z0, z1 = 0.0, 0.0
    for i in range(m):
        pull = weight[i] * (target[i, 0] - origin[i])
        z0 += plane[i, 0] * pull
        z1 += plane[i, 1] * pull
    free = 0.0
    for i in range(m):
        near[i] = origin[i] + plane[i, 0] * z0 + plane[i, 1] * z1
        free += weight[i] * (near[i] - target[i, 0]) ** 2
        length[i] = math.sqrt(plane[i, 0] ** 2 + plane[i, 1] ** 2)
        if length[i] <= PARALLEL:
            if choose_side(near[i], i, masks[i], sides, price, 2.0 * tolerance)[0] < 0:
                return False, math.inf, 0
            continue
        before = math.nan
        for s in range(3):
            if masks[i] >> s & 1:
                for side_end in (sides.low[i, s], sides.high[i, s]):
                    if side_end != before:  # sides may touch, and off is a point
                        lines = _insert(motor, end, away, lines, i, side_end, abs(side_end - near[i]) / length[i])
                        before = side_end

    f, chosen = np.empty(m), np.empty(m)
    best, value = math.inf, math.inf
    changes_best, looked = 0, 0
    # Candidate (p, q): both -1 the point closest to the target, q = -1 the foot on line p, else an intersection.
    for stage in range(3):
        for p in range(-1 if stage == 0 else 0, 0 if stage == 0 else lines):
            if stage > 0 and free + away[p] * away[p] > best + slack_of(best):
                break
            i = motor[p] if stage > 0 else -1
            for q in range(-1 if stage < 2 else 0, 0 if stage < 2 else p):
                j, determinant, y0, y1 = -1, 1.0, 0.0, 0.0
                if stage == 1:
                    step = (end[p] - near[i]) / (length[i] * length[i])
                    y0, y1 = plane[i, 0] * step, plane[i, 1] * step
                elif stage == 2:
                    j = motor[q]
                    determinant = plane[i, 0] * plane[j, 1] - plane[i, 1] * plane[j, 0]
                    if abs(determinant) <= SINE * length[i] * length[j]:
                        continue
                    a, b = end[p] - near[i], end[q] - near[j]
                    y0 = (a * plane[j, 1] - b * plane[i, 1]) / determinant
                    y1 = (b * plane[i, 0] - a * plane[j, 0]) / determinant
                    if free + y0 * y0 + y1 * y1 > best + slack_of(best):
                        continue
                looked += 1
                cost = 0.0
                for h in range(m):
                    f[h] = near[h] + plane[h, 0] * y0 + plane[h, 1] * y1
                    if h == i:
                        f[h] = end[p]
                    elif h == j:
                        f[h] = end[q]
                    s, true = choose_side(f[h], h, masks[h], sides, price, 2.0 * tolerance)
                    if s < 0:
                        cost = math.inf
                        break
                    chosen[h] = s - 1
                    cost += true
                if cost == math.inf:
                    continue
                changes = changed(chosen, previous)
                if not preferred(cost, best, chosen, subset, changes, changes_best):
                    continue
                best, value, changes_best = min(best, cost), cost, changes
                for h in range(m):
                    force[h], subset[h], multiplier[h] = f[h], chosen[h], 0.0
                if stage == 1:
                    multiplier[i] = -(end[p] - near[i]) / (length[i] * length[i])
                elif stage == 2:
                    multiplier[i] = (y1 * plane[j, 0] - y0 * plane[j, 1]) / determinant
                    multiplier[j] = (y0 * plane[i, 1] - y1 * plane[i, 0]) / determinant
    return best < math.inf, value, looked


@compiled
def _insert(
    motor: NDArray[np.int64],
    end: NDArray[np.float64],
    away: NDArray[np.float64],
    lines: int,
    i: int,
    side_end: float,
    distance: float,
) -> int:
    """Put a line into its place by distance; returns the new number of lines."""
    at = lines
    while at > 0 and away[at - 1] > distance:
        motor[at], end[at], away[at] = motor[at - 1], end[at - 1], away[at - 1]
        at -= 1
    motor[at], end[at], away[at] = i, side_end, distance
    return lines + 1
