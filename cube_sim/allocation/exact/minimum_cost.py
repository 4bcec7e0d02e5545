"""The cheapest allowed forces among those that make one wrench, over all alternatives of the objective."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.branch_and_bound import FOUND, GAVE_UP, search
from cube_sim.allocation.exact.planar_vertices import line_search
from cube_sim.allocation.exact.solutions import WrenchFibre
from cube_sim.allocation.exact.step import Tick, price_of, sides_of
from cube_sim.allocation.exact.ties import changed, preferred
from cube_sim.allocation.exact.workspace import Room
from cube_sim.native.compiled import compiled, inlined


@inlined
def cheapest(
    fibre: WrenchFibre,
    plane: NDArray[np.float64],
    planar: bool,
    tick: Tick,
    previous: NDArray[np.float64],
    origin: NDArray[np.float64],
    room: Room,
    spare: NDArray[np.float64],
    force: NDArray[np.float64],
    subset: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> tuple[bool, float, int, int, bool]:
    """Least-cost allowed forces that make the same wrench as ``origin`` (m,).

    Args:
        fibre: of the vehicle.
        plane: (m, 2) see `Tables`.
        planar: see `Tables`.
        tick: sides and prices of this call.
        previous: (m,) subset that ties prefer.
        origin: (m,) [N].
        room: to work in.
        spare: (3, m) the part of it that is used here.
        force: (m,) out [N], clipped to its sides.
        subset: (m,) out.
        multiplier: (m,) out.

    Returns:
        Whether there are any, their cost, the alternative, nodes looked at, whether the answer is proven.
    """
    m = origin.shape[0]
    trial, chosen, mu = spare[0], spare[1], spare[2]
    found, best, winner, nodes, proven, changes_best = False, math.inf, 0, 0, True, 0
    for a in range(tick.targets.shape[0]):
        sides, price = sides_of(tick, a), price_of(tick, a)
        if planar:
            there, cost, looked = line_search(
                origin, plane, sides, price, previous, tick.tolerance, room, trial, chosen, mu
            )
        else:
            outcome, cost, looked = search(
                origin, fibre.kernel, sides, price, previous, tick.tolerance, trial, chosen, mu
            )
            there = outcome == FOUND or (outcome == GAVE_UP and cost < math.inf)
            proven = proven and outcome != GAVE_UP
        nodes += looked
        if not there:
            continue
        changes = changed(chosen, previous)
        if found and not preferred(cost, best, chosen, subset, changes, changes_best):
            continue
        found, best, winner, changes_best = True, cost, a, changes
        for i in range(m):
            s = int(chosen[i]) + 1
            force[i] = min(max(trial[i], tick.low[i, s]), tick.high[i, s]) + 0.0
            subset[i], multiplier[i] = chosen[i], mu[i]
    return found, best, winner, nodes, proven


@compiled
def cost_on(tick: Tick, alternative: int, force: NDArray[np.float64], subset: NDArray[np.float64]) -> float:
    """Cost of forces (m,) on the sides (m,) they lie on, for one alternative of the objective [N^2]."""
    cost = 0.0
    for i in range(force.shape[0]):
        s = int(subset[i]) + 1
        cost += tick.weights[i] * (force[i] - tick.targets[alternative, i, s]) ** 2 + tick.penalty[i, s]
    return cost


@compiled
def snap(
    tick: Tick, wanted: NDArray[np.float64], force: NDArray[np.float64], subset: NDArray[np.float64]
) -> tuple[float, int]:
    """Move each force (m,) to its nearest allowed one; returns the cost and the alternative it is counted for."""
    for i in range(wanted.shape[0]):
        gap, side = math.inf, -1
        for s in range(3):
            if tick.masks[i] >> s & 1:
                here = max(tick.low[i, s] - wanted[i], wanted[i] - tick.high[i, s], 0.0)
                if side < 0 or here < gap:
                    gap, side = here, s
        subset[i] = side - 1
        force[i] = min(max(wanted[i], tick.low[i, side]), tick.high[i, side]) + 0.0
    best, winner = math.inf, 0
    for a in range(tick.targets.shape[0]):
        cost = cost_on(tick, a, force, subset)
        if cost < best:
            best, winner = cost, a
    return best, winner
