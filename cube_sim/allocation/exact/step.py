"""What an allocator remembers from one call to the next, and what follows from it for the next call."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.problem import Tables
from cube_sim.allocation.exact.relaxation import relax
from cube_sim.allocation.exact.sides import Price, Sides
from cube_sim.native.compiled import compiled, inlined


class Memory(NamedTuple):
    """The previous answer: the rows of one (3, m) array, all zeros at the start of a run.

    Attributes:
        subset: (m,) its sides, -1, 0, +1: ties prefer them.
        push: (m,) direction each motor last pushed to, rests passed over: reversals are counted from it.
        travel: (m,) force counted from the edge of the side it lies on [N]: changes are counted in it, so that
            crossing the dead zone is no change and never forbidden.
    """

    subset: NDArray[np.float64]
    push: NDArray[np.float64]
    travel: NDArray[np.float64]


class Tick(NamedTuple):
    """The allowed sides and their prices in one call.

    Attributes:
        low: (m, 3) lower end of each side [N].
        high: (m, 3) upper end of each side [N].
        masks: (m,) bits of the sides that are not empty.
        relaxed: (t, m, 8, 4) from `relax`.
        weights: (m,) w.
        targets: (t, m, 3) alternatives of the objective [N].
        penalty: (m, 3) cost of choosing each side [N^2].
        tolerance: force that counts as rounding [N].
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    masks: NDArray[np.int64]
    relaxed: NDArray[np.float64]
    weights: NDArray[np.float64]
    targets: NDArray[np.float64]
    penalty: NDArray[np.float64]
    tolerance: float


def blank_memory(motors: int) -> NDArray[np.float64]:
    """(3, motors) rows of a `Memory` as at the start of a run: all motors at rest."""
    return np.zeros((3, motors))


@inlined
def sides_of(tick: Tick, alternative: int) -> Sides:
    """The sides of one alternative of the objective."""
    return Sides(tick.low, tick.high, tick.masks, tick.relaxed[alternative])


@inlined
def price_of(tick: Tick, alternative: int) -> Price:
    """The prices of one alternative of the objective."""
    return Price(tick.weights, tick.targets[alternative], tick.penalty)


@compiled
def this_tick(t: Tables, memory: Memory) -> Tick:
    """Sides and prices of the next call: reversals are priced, and forces may move by the change limit only.

    A side out of reach of the change limit is closed; the side a motor is on never is. A reversal is walked: down to
    the edge of the dead zone, across it in no time, and on from the other edge, so a limit smaller than the dead
    zone slows a motor down and never locks it.
    """
    low, high, masks, penalty, relaxed = t.low, t.high, t.masks, t.penalty, t.relaxed
    if t.reversal_penalty > 0.0 or t.switching_penalty > 0.0 or t.change_limit < math.inf:
        low, high, masks, penalty = low.copy(), high.copy(), masks.copy(), penalty.copy()
        for i in range(low.shape[0]):
            if memory.push[i] != 0.0:
                penalty[i, 1 - int(memory.push[i])] = t.reversal_penalty
            if memory.subset[i] == 0.0:
                penalty[i, 0] += t.switching_penalty
                penalty[i, 2] += t.switching_penalty
            else:
                penalty[i, 1] += t.switching_penalty
            if t.change_limit < math.inf:
                masks[i] = 0
                for s in range(3):
                    if low[i, s] <= high[i, s]:
                        bottom = t.edge[i, s] + memory.travel[i] - t.change_limit
                        top = t.edge[i, s] + memory.travel[i] + t.change_limit
                        if bottom - t.tolerance <= high[i, s] and top + t.tolerance >= low[i, s]:
                            # What lies exactly one limit away is within reach, whatever the rounding.
                            low[i, s], high[i, s] = (
                                max(low[i, s], min(bottom, high[i, s])),
                                min(high[i, s], max(top, low[i, s])),
                            )
                            masks[i] |= 1 << s
                        else:
                            low[i, s], high[i, s] = math.inf, -math.inf
        relaxed = np.empty_like(relaxed)
        for a in range(t.targets.shape[0]):
            relax(low, high, t.targets[a], penalty, t.weights, relaxed[a])
    return Tick(low, high, masks, relaxed, t.weights, t.targets, penalty, t.tolerance)


@compiled
def remember(
    edge: NDArray[np.float64], memory: Memory, force: NDArray[np.float64], subset: NDArray[np.float64]
) -> None:
    """Make an answer the previous one.

    Args:
        edge: (m, 3) see `Tables`.
        memory: changed in place.
        force: (m,) [N].
        subset: (m,).
    """
    for i in range(force.shape[0]):
        memory.subset[i] = subset[i]
        if subset[i] != 0:
            memory.push[i] = subset[i]
        memory.travel[i] = force[i] - edge[i, int(subset[i]) + 1]
