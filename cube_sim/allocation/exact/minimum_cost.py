"""The cheapest allowed forces among those that make one wrench, over all alternatives of the objective."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.branch_and_bound import FOUND, GAVE_UP, branch_and_bound
from cube_sim.allocation.exact.planar_vertices import planar_search
from cube_sim.allocation.exact.solutions import ForceSolutions
from cube_sim.allocation.exact.step import StepLimits, intervals_of, side_cost_of
from cube_sim.allocation.exact.ties import count_changes, preferred
from cube_sim.allocation.exact.workspace import Workspace
from cube_sim.native.compiled import compiled, inlined


@inlined
def minimum_cost_forces(
    solutions: ForceSolutions,
    plane: NDArray[np.float64],
    planar: bool,
    limits: StepLimits,
    previous: NDArray[np.float64],
    origin: NDArray[np.float64],
    workspace: Workspace,
    scratch: NDArray[np.float64],
    force: NDArray[np.float64],
    subset: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> tuple[bool, float, int, int, bool]:
    """Least-cost allowed forces that make the same wrench as ``origin`` (m,).

    Args:
        solutions: of the vehicle.
        plane: (m, 2) see `AllocationProblem`.
        planar: see `AllocationProblem`.
        limits: sides and costs of this call.
        previous: (m,) subset that ties prefer.
        origin: (m,) [N].
        workspace: scratch rows of the searches.
        scratch: (3, m) rows of it that are used here.
        force: (m,) out [N], clipped to its sides.
        subset: (m,) out.
        multiplier: (m,) out.

    Returns:
        Whether there are any, their cost [N^2], the alternative, nodes looked at, whether the answer is proven.
    """
    m = origin.shape[0]
    trial, chosen, mu = scratch[0], scratch[1], scratch[2]
    found, best, winner, nodes, proven, changes_best = False, math.inf, 0, 0, True, 0
    for a in range(limits.targets.shape[0]):
        intervals, side_cost = intervals_of(limits, a), side_cost_of(limits, a)
        if planar:
            there, cost, looked = planar_search(
                origin, plane, intervals, side_cost, previous, limits.tolerance, workspace, trial, chosen, mu
            )
        else:
            outcome, cost, looked = branch_and_bound(
                origin, solutions.null_space, intervals, side_cost, previous, limits.tolerance, trial, chosen, mu
            )
            there = outcome == FOUND or (outcome == GAVE_UP and cost < math.inf)
            proven = proven and outcome != GAVE_UP
        nodes += looked
        if not there:
            continue
        changes = count_changes(chosen, previous)
        if found and not preferred(cost, best, chosen, subset, changes, changes_best):
            continue
        found, best, winner, changes_best = True, cost, a, changes
        for i in range(m):
            s = int(chosen[i]) + 1
            force[i] = min(max(trial[i], limits.low[i, s]), limits.high[i, s]) + 0.0
            subset[i], multiplier[i] = chosen[i], mu[i]
    return found, best, winner, nodes, proven


@compiled
def cost_on(limits: StepLimits, alternative: int, force: NDArray[np.float64], subset: NDArray[np.float64]) -> float:
    """Cost of forces (m,) on the sides (m,) they lie on, for one alternative of the objective [N^2]."""
    cost = 0.0
    for i in range(force.shape[0]):
        s = int(subset[i]) + 1
        cost += limits.weights[i] * (force[i] - limits.targets[alternative, i, s]) ** 2 + limits.penalty[i, s]
    return cost


@compiled
def nearest_allowed(
    limits: StepLimits, wanted: NDArray[np.float64], force: NDArray[np.float64], subset: NDArray[np.float64]
) -> tuple[float, int]:
    """Move each force to its nearest allowed one.

    Args:
        limits: sides and costs of this call.
        wanted: (m,) [N].
        force: (m,) out [N].
        subset: (m,) out.

    Returns:
        The cost [N^2] and the alternative it is counted for, the cheapest.
    """
    for i in range(wanted.shape[0]):
        gap, side = math.inf, -1
        for s in range(3):
            if limits.masks[i] >> s & 1:
                here = max(limits.low[i, s] - wanted[i], wanted[i] - limits.high[i, s], 0.0)
                if side < 0 or here < gap:
                    gap, side = here, s
        subset[i] = side - 1
        force[i] = min(max(wanted[i], limits.low[i, side]), limits.high[i, side]) + 0.0
    best, winner = math.inf, 0
    for a in range(limits.targets.shape[0]):
        cost = cost_on(limits, a, force, subset)
        if cost < best:
            best, winner = cost, a
    return best, winner
