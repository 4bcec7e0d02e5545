"""The exact search: which subset of thruster sides makes a wrench at the least cost, with proof that none is better."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.active_set import CUT, INFEASIBLE, STALLED, project_within, scratch
from cube_sim.allocation.exact.relaxation import branch, choose_side, split
from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.allocation.exact.ties import count_changes, preferred, tie_tolerance
from cube_sim.native.compiled import compiled

FOUND, NONE, GAVE_UP = 0, 1, 2
"""Outcomes: the optimum; no allowed forces make the wrench; a projection stalled or there were too many: not proven."""


ACCEPTED = 2.001
"""Distance from a side, in tolerances, at which a force still lies on it. The projections keep to 2: what is accepted
on a side is then attainable with that side alone, and the cheapest force of a subset is never missed at its border."""

MOST_NODES = 20_000
"""Projections after which a search gives up its proof and answers with its best. Eight thrusters take hundreds."""


@compiled
def branch_and_bound(
    origin: NDArray[np.float64],
    null_space: NDArray[np.float64],
    intervals: SideIntervals,
    side_cost: SideCost,
    previous: NDArray[np.float64],
    tolerance: float,
    force: NDArray[np.float64],
    subset: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> tuple[int, float, int]:
    """Minimise ``sum w (f - target)^2 + penalty`` over ``f = origin + null_space z`` with every f_i on an allowed side.

    Branch and bound over the thrusters, depth first. A node leaves each thruster a set of sides. Relaxing each set to
    one interval (`relax`) makes the node one projection in the k coordinates z. Its value is a lower bound for
    everything below the node:

    ======================================  =====================================================================
    the node's projection                   what follows
    ======================================  =====================================================================
    does not exist                          no forces lie below the node: leave it
    costs more than the best                nothing below is better: leave it
    lies off a thruster's sides             divide the node: the thruster that is furthest off decides its side
    lies on allowed sides                   it is an answer, the best one or not, and
    - and costs its lower bound             nothing below is better: leave the node
    - and costs more                        divide the node: the thruster whose bound is loosest decides its side
    ======================================  =====================================================================

    Nothing is left unless its lower bound exceeds the best cost found, so the answer is the optimum over all subsets.

    Ties within rounding go to the subset with the fewest changes from ``previous``, then to the one whose first
    differing thruster pushes forward.

    Args:
        origin: (m,) any forces making the wrench [N].
        null_space: (m, k) with ``null_space.T @ diag(w) @ null_space = I``.
        intervals: open to the thrusters.
        side_cost: of the sides; what ``intervals.relaxed`` was made with.
        previous: (m,) subset that ties prefer.
        tolerance: force that counts as rounding [N].
        force: (m,) out [N].
        subset: (m,) out: -1, 0, +1.
        multiplier: (m,) out: multipliers of the interval ends in the last projection that won.

    Returns:
        Outcome, cost of ``force``, and the number of projections solved.
    """
    m, k = null_space.shape
    relaxed, weight = intervals.relaxed, side_cost.weight
    low, high = intervals.low, intervals.high
    stack = np.empty((2 * m + 2, m), np.int64)
    bound = np.empty(2 * m + 2)
    bottom, top = np.empty(m), np.empty(m)
    start, point = np.empty(k), np.empty(k)
    work, active = scratch(k)
    f, mu = np.empty(m), np.empty(m)
    chosen = np.empty(m)
    mask = np.empty(m, np.int64)
    best, value_best = math.inf, math.inf
    changes_best = 0
    proven = True
    solved = 0
    for i in range(m):
        stack[0, i] = intervals.masks[i]
    bound[0] = -math.inf
    depth = 1
    while depth > 0:
        if solved >= MOST_NODES:
            proven = False
            break
        depth -= 1
        slack = tie_tolerance(best)
        bound_here = bound[depth]
        if bound_here > best + slack:
            continue
        empty = False
        constant = 0.0
        for i in range(m):
            mask[i] = stack[depth, i]
            bottom[i], top[i] = relaxed[i, mask[i], 0], relaxed[i, mask[i], 1]
            constant += relaxed[i, mask[i], 3]
            empty = empty or bottom[i] > top[i]
        if empty:
            continue
        for a in range(k):
            start[a] = 0.0
        for i in range(m):
            weighted = weight[i] * (relaxed[i, mask[i], 2] - origin[i])
            for a in range(k):
                start[a] += null_space[i, a] * weighted
        unconstrained = constant
        for i in range(m):
            value = origin[i] - relaxed[i, mask[i], 2]
            for a in range(k):
                value += null_space[i, a] * start[a]
            unconstrained += weight[i] * value * value
            bottom[i] -= origin[i]
            top[i] -= origin[i]
        cutoff = best + slack - unconstrained
        outcome = project_within(null_space, bottom, top, start, cutoff, 2.0 * tolerance, point, mu, work, active)
        solved += 1
        if outcome == INFEASIBLE or outcome == CUT:  # noqa: SIM109 - compiles faster
            continue
        if outcome == STALLED:  # no bound for this node: divide it where it can be divided
            for i in range(m):
                single = mask[i] & -mask[i]
                if single != mask[i]:
                    depth = branch(stack, bound, depth, mask, i, (single, mask[i] ^ single), bound_here)
                    break
            else:
                proven = False
            continue
        lower, cost = constant, 0.0
        divided, worst = -1, 0.0
        off, furthest = -1, 0.0
        for i in range(m):
            value = origin[i]
            for a in range(k):
                value += null_space[i, a] * point[a]
            f[i] = value
            here = weight[i] * (value - relaxed[i, mask[i], 2]) ** 2
            lower += here
            s, true = choose_side(value, i, mask[i], intervals, side_cost, ACCEPTED * tolerance)
            chosen[i] = s - 1
            if s < 0:
                gap = math.inf
                for other in range(3):
                    if mask[i] >> other & 1 and low[i, other] <= high[i, other]:
                        gap = min(gap, max(low[i, other] - value, value - high[i, other]))
                if gap > furthest:
                    off, furthest = i, gap
            else:
                cost += true
                if true - here - relaxed[i, mask[i], 3] > worst:
                    divided, worst = i, true - here - relaxed[i, mask[i], 3]
        if lower > best + slack:
            continue
        if off < 0:
            changes = count_changes(chosen, previous)
            if preferred(cost, best, chosen, subset, changes, changes_best):
                best, value_best, changes_best = min(best, cost), cost, changes
                for i in range(m):
                    force[i], subset[i], multiplier[i] = f[i], chosen[i], mu[i]
            if divided < 0 or worst <= 1e-12 * abs(best):
                continue
        else:
            divided = off
        first, second = split(f[divided], divided, mask[divided], intervals)
        depth = branch(stack, bound, depth, mask, divided, (second, first), lower)
    if not proven:
        return GAVE_UP, value_best, solved
    return (FOUND if best < math.inf else NONE), value_best, solved
