"""One allocation after the other, compiled whole: exact, else closest; then wrench, error, cost and memory."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.lines import line_search
from cube_sim.allocation.memory import Memory, Tick, remember, this_tick
from cube_sim.allocation.nearest import CANDIDATES, nearest
from cube_sim.allocation.scaled import largest_scale
from cube_sim.allocation.search import FOUND, GAVE_UP, search
from cube_sim.allocation.tables import Packed, Tables, unpack
from cube_sim.allocation.ties import changed, preferred
from cube_sim.compiled import compiled

EXACT, CLOSEST, INVALID_WRENCH, UNPROVEN, UNPROVEN_CLOSEST, SCALED = 0, 1, 2, 5, 6, 7
"""The numbers of `Status`."""

FAR = 1e3
"""Demands longer than this many times the reach are shortened for the search; the closest wrench is the same."""


HUGE = 1e300
"""Errors beyond this are all the same [N]; it keeps the residual of the largest demands a number."""


class Answers(NamedTuple):
    """Where N answers are written; one row of numbers each, and the subsets.

    Attributes:
        numbers: (N, 4 m + 2 n + 6): force, wrench, error, multipliers of the interval ends at the solution of the
            subset's problem, lower and upper ends of the chosen sides, then residual, cost, status, winning
            alternative of the objective, nodes looked at, and 1 where the answer is not proven.
        subset: (N, m) int8.
    """

    numbers: NDArray[np.float64]
    subset: NDArray[np.int8]


class Answer(NamedTuple):
    """One row of `Answers`, by name.

    Attributes:
        force: (m,) [N].
        wrench: (n,) A f.
        error: (n,) demanded minus achieved.
        multiplier: (m,) of the interval ends.
        low: (m,) lower end of the side each motor is on [N].
        high: (m,) upper end of it [N].
        rest: (6,) residual [N], cost [N^2], status, alternative, nodes, not proven.
    """

    force: NDArray[np.float64]
    wrench: NDArray[np.float64]
    error: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    rest: NDArray[np.float64]


def blank_answers(count: int, rows: int, motors: int) -> Answers:
    """Room for ``count`` answers."""
    return Answers(np.zeros((count, 4 * motors + 2 * rows + 6)), np.zeros((count, motors), np.int8))


@compiled
def answer_of(numbers: NDArray[np.float64], n: int, m: int) -> Answer:
    """Name the parts of one row of `Answers.numbers`."""
    a, b = m + n, m + 2 * n
    return Answer(
        numbers[:m], numbers[m:a], numbers[a:b], numbers[b : b + m], numbers[b + m : b + 2 * m],
        numbers[b + 2 * m : b + 3 * m], numbers[b + 3 * m :],
    )  # fmt: skip


@compiled
def cheapest(
    t: Tables,
    tick: Tick,
    memory: Memory,
    origin: NDArray[np.float64],
    force: NDArray[np.float64],
    subset: NDArray[np.int8],
    multiplier: NDArray[np.float64],
) -> tuple[bool, float, int, int, bool]:
    """Least-cost allowed forces that make the same wrench as ``origin`` (m,), over all alternatives of the objective.

    Args:
        t: of the allocator.
        tick: sides and prices of this call.
        memory: ties prefer its subset.
        origin: (m,) [N].
        force: (m,) out [N], clipped to its sides.
        subset: (m,) out.
        multiplier: (m,) out.

    Returns:
        Whether there are any, their cost, the alternative, nodes looked at, whether the answer is proven.
    """
    m = origin.shape[0]
    trial, sides, mu = np.empty(m), np.empty(m, np.int8), np.empty(m)
    found, best, winner, nodes, proven, changes_best = False, math.inf, 0, 0, True, 0
    for a in range(t.targets.shape[0]):
        if t.planar:
            there, cost, looked = line_search(
                origin, t.plane, t.weights, tick.low, tick.high, t.targets[a], tick.penalty, tick.masks,
                memory.subset, t.tolerance, trial, sides, mu,
            )  # fmt: skip
        else:
            outcome, cost, looked = search(
                origin, t.kernel, t.weights, tick.low, tick.high, t.targets[a], tick.penalty, tick.relaxed[a],
                tick.masks, memory.subset, t.tolerance, trial, sides, mu,
            )  # fmt: skip
            there = outcome == FOUND or (outcome == GAVE_UP and cost < math.inf)
            proven = proven and outcome != GAVE_UP
        nodes += looked
        if not there:
            continue
        changes = changed(sides, memory.subset)
        if found and not preferred(cost, best, sides, subset, changes, changes_best):
            continue
        found, best, winner, changes_best = True, cost, a, changes
        for i in range(m):
            s = sides[i] + 1
            force[i] = min(max(trial[i], tick.low[i, s]), tick.high[i, s]) + 0.0
            subset[i], multiplier[i] = sides[i], mu[i]
    return found, best, winner, nodes, proven


@compiled
def cost_on(t: Tables, tick: Tick, alternative: int, force: NDArray[np.float64], subset: NDArray[np.int8]) -> float:
    """Cost of forces (m,) on the sides (m,) they lie on, for one alternative of the objective [N^2]."""
    cost = 0.0
    for i in range(force.shape[0]):
        s = subset[i] + 1
        cost += t.weights[i] * (force[i] - t.targets[alternative, i, s]) ** 2 + tick.penalty[i, s]
    return cost


@compiled
def snap(
    t: Tables, tick: Tick, wanted: NDArray[np.float64], force: NDArray[np.float64], subset: NDArray[np.int8]
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
    for a in range(t.targets.shape[0]):
        cost = cost_on(t, tick, a, force, subset)
        if cost < best:
            best, winner = cost, a
    return best, winner


@compiled
def nearest_origins(t: Tables, tick: Tick, demand: NDArray[np.float64]) -> tuple[NDArray[np.float64], int, bool]:
    """Forces making the wrenches closest to a demand.

    Args:
        t: of the allocator.
        tick: sides of this call.
        demand: (n,) finite.

    Returns:
        (c, m) forces, one row per distinct equally close wrench; when every projection stalled, the one row of the
        pseudo-inverse, to be moved to allowed sides. Then nodes looked at, and whether the answer is proven.
    """
    n, m = t.A.shape
    scale = shortened(t, demand)
    goal = reachable(t, demand, scale)
    candidates = np.zeros((CANDIDATES, m))
    count, _, proven, nodes = nearest(
        goal, t.spread, t.free, t.gain, tick.low, tick.high, tick.relaxed[0], tick.masks, t.tolerance, candidates
    )
    if count == 0:
        for i in range(m):
            for a in range(n):
                candidates[0, i] += t.particular[i, a] * (demand[a] * scale)
        return candidates[:1], nodes, False
    return candidates[:count], nodes, proven


@compiled
def shortened(t: Tables, demand: NDArray[np.float64]) -> float:
    """Factor that makes a demand (n,) far beyond reach shorter, so that no product overflows; else 1."""
    size = 0.0
    for a in range(demand.shape[0]):
        size = max(size, abs(demand[a]))
    limit = FAR * max(t.reach, 1e-12)
    return limit / size if size > limit else 1.0


@compiled
def reachable(t: Tables, demand: NDArray[np.float64], scale: float) -> NDArray[np.float64]:
    """Coordinates s (r,) of `WrenchDistance` of a scaled demand (n,), what no forces of any size can make left out."""
    goal = np.zeros(t.basis.shape[1])
    for b in range(goal.shape[0]):
        for a in range(demand.shape[0]):
            goal[b] += t.basis[a, b] * t.wrench_weights[a] * (demand[a] * scale)
    return goal


@compiled
def scaled_origin(
    t: Tables, tick: Tick, demand: NDArray[np.float64], origin: NDArray[np.float64], part: NDArray[np.float64]
) -> tuple[int, bool]:
    """The largest attainable part of a demand in its own direction; none of it where there is no such part.

    Args:
        t: of the allocator.
        tick: sides of this call.
        demand: (n,) finite.
        origin: (m,) out: forces making that part, limits aside [N].
        part: (n,) out: the demand, scaled.

    Returns:
        Nodes looked at, whether the answer is proven.
    """
    n, m = t.A.shape
    r, h = t.facets.shape[1], t.facets.shape[0]
    short = shortened(t, demand)
    goal = reachable(t, demand, short)
    across, gain = np.zeros(h), np.zeros((h, m))
    size = 0.0
    for f in range(h):
        for b in range(r):
            across[f] += t.facets[f, b] * goal[b]
            for i in range(m):
                gain[f, i] += t.facets[f, b] * t.gain[b, i]
        for i in range(m):
            size = max(size, abs(gain[f, i]))
    rounding = 1e-3 * size * t.tolerance  # well below what the search for the forces counts as rounding
    scale, proven, nodes = largest_scale(across, gain, tick.low, tick.high, tick.relaxed[0], tick.masks, rounding)
    scale = max(scale, 0.0)
    for i in range(m):
        origin[i] = 0.0
        for b in range(r):
            origin[i] += t.spread[i, b] * (goal[b] * scale)
    for a in range(n):
        part[a] = demand[a] * short * scale
    return nodes, proven


@compiled
def closest(
    t: Tables,
    tick: Tick,
    memory: Memory,
    demand: NDArray[np.float64],
    force: NDArray[np.float64],
    subset: NDArray[np.int8],
    multiplier: NDArray[np.float64],
) -> tuple[float, int, int, bool]:
    """Forces making the attainable wrench closest to the demand, of those the cheapest.

    Args:
        t: of the allocator.
        tick: sides and prices of this call.
        memory: ties prefer its subset.
        demand: (n,) finite.
        force: (m,) out [N].
        subset: (m,) out.
        multiplier: (m,) out.

    Returns:
        Cost, alternative, nodes looked at, whether the answer is proven.
    """
    m = t.A.shape[1]
    candidates, nodes, proven = nearest_origins(t, tick, demand)
    trial, sides, mu = np.empty(m), np.empty(m, np.int8), np.empty(m)
    best, winner, changes_best = math.inf, 0, 0
    for c in range(candidates.shape[0]):
        there, cost, alternative, looked, sure = cheapest(t, tick, memory, candidates[c], trial, sides, mu)
        nodes += looked
        proven = proven and sure
        if not there:
            cost, alternative = snap(t, tick, candidates[c], trial, sides)
            for i in range(m):
                mu[i] = 0.0
        changes = changed(sides, memory.subset)
        if c > 0 and not preferred(cost, best, sides, subset, changes, changes_best):
            continue
        best, winner, changes_best = cost, alternative, changes
        for i in range(m):
            force[i], subset[i], multiplier[i] = trial[i], sides[i], mu[i]
    return best, winner, nodes, proven


@compiled
def attainable_origin(t: Tables, demand: NDArray[np.float64], origin: NDArray[np.float64]) -> bool:
    """Write the least forces making the demand, limits aside; False when no forces of any size can, or it is far."""
    n, m = t.A.shape
    for a in range(n):
        if abs(demand[a]) > 2.0 * t.reach:
            return False
    for b in range(n):
        outside = 0.0
        for a in range(n):
            outside += t.unreachable[b, a] * demand[a]
        if abs(outside) > t.tolerance:
            return False
    for i in range(m):
        origin[i] = 0.0
        for a in range(n):
            origin[i] += t.particular[i, a] * demand[a]
    return True


@compiled
def complete(
    t: Tables, demand: NDArray[np.float64], force: NDArray[np.float64], wrench: NDArray[np.float64],
    error: NDArray[np.float64],
) -> float:  # fmt: skip
    """Write the wrench (n,) of forces (m,) and its error (n,) against the demand (n,); returns the residual [N]."""
    largest = 0.0
    for a in range(demand.shape[0]):
        wrench[a] = 0.0
        for i in range(force.shape[0]):
            wrench[a] += t.A[a, i] * force[i]
        error[a] = demand[a] - wrench[a]
        largest = max(largest, min(abs(error[a] * t.error_scale[a]), HUGE))
    if largest == 0.0:
        return 0.0
    square = 0.0
    for a in range(demand.shape[0]):
        square += (min(abs(error[a] * t.error_scale[a]), HUGE) / largest) ** 2
    return largest * math.sqrt(square)


@compiled
def allocate_each(packed: Packed, memory: Memory, wrenches: NDArray[np.float64], answers: Answers) -> None:
    """Allocate N demands (N, n) in order, each remembering the one before.

    A demand that holds a NaN or an infinity counts as zero.
    """
    t = unpack(packed)
    n, m = t.A.shape
    demand, part, origin = np.empty(n), np.empty(n), np.empty(m)
    for at in range(wrenches.shape[0]):
        status = EXACT
        for a in range(n):
            demand[a] = wrenches[at, a]
            if not math.isfinite(demand[a]):
                status = INVALID_WRENCH
        if status == INVALID_WRENCH:
            for a in range(n):
                demand[a] = 0.0
        tick = this_tick(t, memory)
        answer, subset = answer_of(answers.numbers[at], n, m), answers.subset[at]
        found, alternative, nodes, proven = False, 0, 0, True
        if attainable_origin(t, demand, origin):
            found, _, alternative, nodes, proven = cheapest(
                t, tick, memory, origin, answer.force, subset, answer.multiplier
            )
        if not found:
            for a in range(n):
                part[a] = demand[a]
            if status == EXACT:
                status = CLOSEST
                if t.facets.shape[0] > 0:
                    status = SCALED
                    more, sure = scaled_origin(t, tick, demand, origin, part)
                    nodes += more
                    found, _, alternative, more, cheap = cheapest(
                        t, tick, memory, origin, answer.force, subset, answer.multiplier
                    )
                    nodes += more
                    proven = proven and sure and cheap
            if not found:
                _, alternative, more, sure = closest(t, tick, memory, part, answer.force, subset, answer.multiplier)
                nodes += more
                proven = proven and sure
        answer.rest[0] = complete(t, demand, answer.force, answer.wrench, answer.error)
        answer.rest[1] = cost_on(t, tick, alternative, answer.force, subset)
        if not proven and status != INVALID_WRENCH:
            status = UNPROVEN if status == EXACT else UNPROVEN_CLOSEST
        answer.rest[2], answer.rest[3] = status, alternative
        answer.rest[4], answer.rest[5] = nodes, 0.0 if proven else 1.0
        for i in range(m):
            answer.low[i], answer.high[i] = tick.low[i, subset[i] + 1], tick.high[i, subset[i] + 1]
        remember(t, memory, answer.force, subset)
