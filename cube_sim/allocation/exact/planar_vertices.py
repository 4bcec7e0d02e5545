"""The exact search where the forces have at most two degrees of freedom left: every possible optimum, one by one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.allocation.exact.ties import tie_tolerance
from cube_sim.allocation.exact.workspace import Workspace
from cube_sim.native.compiled import bits, compiled
from cube_sim.wrench.tolerances import CROSSING, PARALLEL

SINE = math.sqrt(PARALLEL * CROSSING)
"""Tells the two apart."""

WHICH = 255
"""Bits of a line's key that say which line it is. The others are its distance's, up to a part of 1e-13; in a plane
there are 48 lines at most, six for each of eight thrusters."""


def suits_planar_search(plane: NDArray[np.float64]) -> bool:
    """Whether every two lines are clearly parallel or clearly crossing, so that no intersection is rounding.

    Args:
        plane: (m, 2) see `planar_search`.
    """
    length = np.linalg.norm(plane, axis=1)
    unit = plane[length > PARALLEL] / length[length > PARALLEL, None]
    sine = np.abs(np.outer(unit[:, 0], unit[:, 1]) - np.outer(unit[:, 1], unit[:, 0]))
    return not np.any((sine > PARALLEL) & (sine < CROSSING))


@compiled
def planar_search(
    origin: NDArray[np.float64],
    plane: NDArray[np.float64],
    intervals: SideIntervals,
    side_cost: SideCost,
    previous: NDArray[np.float64],
    tolerance: float,
    room: Workspace,
    force: NDArray[np.float64],
    subset: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> tuple[bool, float, int]:
    """Minimise ``sum w (f - target)^2 + penalty`` over ``f = origin + plane z`` with every f_i on an allowed side.

    In the plane of z each end of each side is a line, each subset a convex polygon between lines, and the cost is
    the squared distance from one point plus the penalties. The optimum of a polygon is that point, or the foot of
    its perpendicular on a line, or an intersection of two lines, and it presses on its lines from inside the
    polygon: who leaves a line for the other side of it is no optimum. So the cheapest of these that is allowed is
    the optimum over all subsets; those farther away than the best so far need no look.

    Args:
        origin: (m,) any forces making the wrench [N].
        plane: (m, 2) null_space with ``plane.T @ diag(w) @ plane = I``, columns of zeros for missing dimensions.
        intervals: open to the thrusters.
        side_cost: of them, with one preferred force for all sides of a thruster.
        previous: (m,) subset that ties prefer.
        tolerance: force that counts as rounding [N].
        room: to work in.
        force: (m,) out [N].
        subset: (m,) out: -1, 0, +1.
        multiplier: (m,) out: multipliers of the interval ends.

    Returns:
        Whether there is an answer, its cost, and the number of points looked at.
    """
    m = origin.shape[0]
    low, high, masks = intervals.low, intervals.high, intervals.masks
    weight, target, penalty = side_cost.weight, side_cost.target, side_cost.penalty
    slip = 2.0 * tolerance
    lined, thrusters, numbers = room.lines, room.planes, room.counts
    away, end, due = lined[0], lined[1], lined[2]  # lines: signed distance, force, penalty
    n0, n1 = lined[3], lined[4]  # unit normals
    near, length, p0, p1 = (
        thrusters[0],
        thrusters[1],
        thrusters[2],
        thrusters[3],
    )  # nearest forces, allowed or not; normals
    low0, low1, low2, high0, high1, high2 = (
        thrusters[4],
        thrusters[5],
        thrusters[6],
        thrusters[7],
        thrusters[8],
        thrusters[9],
    )
    thruster, press, keys, chosen = numbers[0], numbers[1], numbers[2], numbers[3]
    z0, z1 = 0.0, 0.0
    for i in range(m):
        p0[i], p1[i] = plane[i, 0], plane[i, 1]
        low0[i], low1[i], low2[i] = low[i, 0] - slip, low[i, 1] - slip, low[i, 2] - slip
        high0[i], high1[i], high2[i] = high[i, 0] + slip, high[i, 1] + slip, high[i, 2] + slip
        pull = weight[i] * (target[i, 0] - origin[i])
        z0 += plane[i, 0] * pull
        z1 += plane[i, 1] * pull
    free, lines = 0.0, 0
    for i in range(m):
        near[i] = origin[i] + plane[i, 0] * z0 + plane[i, 1] * z1
        free += weight[i] * (near[i] - target[i, 0]) ** 2
        length[i] = math.sqrt(plane[i, 0] ** 2 + plane[i, 1] ** 2)
        if length[i] <= PARALLEL:
            inside = False
            for s in range(3):
                inside = inside or (low[i, s] - slip <= near[i] and near[i] <= high[i, s] + slip)
            if not inside:
                return False, math.inf, 0
            continue
        for s in range(3):
            if masks[i] >> s & 1:
                for upper in range(2):
                    side_end = high[i, s] if upper else low[i, s]
                    if lines > 0 and thruster[lines - 1] == i and end[lines - 1] == side_end:
                        press[lines - 1] = 0  # sides touch, or off, which is a point: thrusters press from either side
                        due[lines - 1] = min(due[lines - 1], penalty[i, s])
                        continue
                    thruster[lines], end[lines], press[lines] = i, side_end, 1 - 2 * upper
                    due[lines] = penalty[i, s]
                    away[lines] = (side_end - near[i]) / length[i]
                    keys[lines] = bits(abs(away[lines])) & ~WHICH | lines
                    lines += 1

    best, value = math.inf, math.inf
    changes_best, looked = 0, 0
    # Candidate (p, q): both -1 the point closest to the target, q = -1 the foot on line p, else an intersection.
    for p in range(-1, lines):
        i, d, toll = -1, 0.0, 0.0
        if p >= 0:  # the nearest line is the next one; the least key is found without a branch
            rest = keys[p:lines]
            lowest = rest[0]
            for other in range(rest.shape[0]):
                lowest = min(lowest, rest[other])
            nearest = lowest & WHICH
            keys[nearest] = keys[p] & ~WHICH | nearest
            away[p], away[nearest] = away[nearest], away[p]
            end[p], end[nearest] = end[nearest], end[p]
            due[p], due[nearest] = due[nearest], due[p]
            thruster[p], thruster[nearest] = thruster[nearest], thruster[p]
            press[p], press[nearest] = press[nearest], press[p]
            i, d, toll = thruster[p], away[p], due[p]
            n0[p], n1[p] = plane[i, 0] / length[i], plane[i, 1] / length[i]
        bound = free + d * d
        if bound > best + tie_tolerance(best):
            break
        if bound + toll > best + tie_tolerance(best):
            continue
        for q in range(-1, max(p, 0)):
            j, off, y0, y1, sine = -1, 0.0, 0.0, 0.0, 1.0
            left = best + tie_tolerance(best) - bound - toll
            if q >= 0:
                j = thruster[q]
                sine = n0[p] * n1[q] - n1[p] * n0[q]
                cosine = n0[p] * n0[q] + n1[p] * n1[q]
                off = away[q] - cosine * d
                rounding = -1e-9 * (abs(d) + abs(away[q]))
                if (
                    (abs(sine) <= SINE)
                    | (off * off > (left - due[q]) * sine * sine)
                    | (press[q] * off < rounding)
                    | (press[p] * (d - cosine * away[q]) < rounding)
                ):
                    continue
                off /= sine
                y0, y1 = d * n0[p] - off * n1[p], d * n1[p] + off * n0[p]
            elif p >= 0:
                if press[p] * d < 0.0:
                    continue
                y0, y1 = d * n0[p], d * n1[p]
            looked += 1
            blur = 1e-9 * (abs(y0) + abs(y1))  # what rounding may do to forces that are known to lie on their lines
            forbidden = 0
            for h in range(m):  # without a branch, so that it takes a few instructions for all thrusters at once
                here = near[h] + p0[h] * y0 + p1[h] * y1
                under, over = here + blur, here - blur
                forbidden |= int(
                    ((under < low0[h]) | (over > high0[h]))
                    & ((under < low1[h]) | (over > high1[h]))
                    & ((under < low2[h]) | (over > high2[h]))
                )
            if forbidden:
                continue
            first = end[p] if p >= 0 else 0.0
            second = end[q] if q >= 0 else 0.0
            prices = 0.0
            for h in range(m):
                here = first if h == i else (second if h == j else near[h] + p0[h] * y0 + p1[h] * y1)
                side, least = 0, math.inf
                for turn in range(3):  # where sides touch at one price, off wins, then the side of the force's sign
                    s = 1 if turn == 0 else (0 if (turn == 1) == (here < 0.0) else 2)
                    inside = (low[h, s] - slip <= here) & (here <= high[h, s] + slip)
                    if inside and penalty[h, s] < least:
                        side, least = s, penalty[h, s]
                chosen[h] = side
                prices += least
            cost = bound + off * off + prices
            if prices == math.inf or cost > best + tie_tolerance(best):
                continue
            changes, forward = 0, 0
            for h in range(m):
                changes += chosen[h] - 1 != previous[h]
                if forward == 0 and best < math.inf:
                    forward = chosen[h] - 1 - int(subset[h])
            slack = tie_tolerance(best)
            if cost >= best - slack and (changes > changes_best or (changes == changes_best and forward <= 0)):
                continue
            best, value, changes_best = min(best, cost), cost, changes
            for h in range(m):
                force[h] = near[h] + p0[h] * y0 + p1[h] * y1
                subset[h], multiplier[h] = chosen[h] - 1.0, 0.0
            if p >= 0:
                force[i], multiplier[i] = first, -d / length[i]
            if q >= 0:
                force[j], multiplier[j] = second, (y0 * n1[p] - y1 * n0[p]) / (sine * length[j])
                multiplier[i] = (y1 * n0[q] - y0 * n1[q]) / (sine * length[i])
    return best < math.inf, value, looked
