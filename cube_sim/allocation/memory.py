"""What an allocator remembers from one call to the next, and what follows from it for the next call."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.relaxation import relax
from cube_sim.allocation.tables import Tables
from cube_sim.compiled import compiled


class Memory(NamedTuple):
    """The previous answer; all zeros at the start of a run.

    Attributes:
        subset: (m,) int8 its sides: ties prefer them.
        push: (m,) int8 direction each motor last pushed to, rests passed over: reversals are counted from it.
        travel: (m,) force counted from the edge of the side it lies on [N]: changes are counted in it, so that
            crossing the dead zone is no change and never forbidden.
    """

    subset: NDArray[np.int8]
    push: NDArray[np.int8]
    travel: NDArray[np.float64]


class Tick(NamedTuple):
    """The allowed sides and their prices in one call.

    Attributes:
        low: (m, 3) lower end of each side [N].
        high: (m, 3) upper end of each side [N].
        masks: (m,) bits of the sides that are not empty.
        penalty: (m, 3) cost of choosing each side [N^2].
        relaxed: (t, m, 8, 4) from `relax`.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    masks: NDArray[np.uint8]
    penalty: NDArray[np.float64]
    relaxed: NDArray[np.float64]


def blank_memory(motors: int) -> Memory:
    """The memory at the start of a run: all motors at rest."""
    return Memory(np.zeros(motors, np.int8), np.zeros(motors, np.int8), np.zeros(motors))


def copied(memory: Memory) -> Memory:
    """The same memory, from now on its own."""
    return Memory(memory.subset.copy(), memory.push.copy(), memory.travel.copy())


@compiled
def this_tick(t: Tables, memory: Memory) -> Tick:
    """Sides and prices of the next call: reversals are priced, and forces may move by the change limit only.

    A side out of reach of the change limit is closed; the side a motor is on never is. A reversal is walked: down to
    the edge of the dead zone, across it in no time, and on from the other edge, so a limit smaller than the dead
    zone slows a motor down and never locks it.
    """
    if t.reversal_penalty == 0.0 and t.change_limit == math.inf:
        return Tick(t.low, t.high, t.masks, t.penalty, t.relaxed)
    low, high, masks, penalty = t.low.copy(), t.high.copy(), t.masks.copy(), t.penalty.copy()
    for i in range(low.shape[0]):
        if memory.push[i] != 0:
            penalty[i, 1 - memory.push[i]] = t.reversal_penalty
        if t.change_limit < math.inf:
            bottom, top = memory.travel[i] - t.change_limit, memory.travel[i] + t.change_limit
            masks[i] = 0
            for s in range(3):
                if low[i, s] <= high[i, s]:
                    low[i, s] = max(low[i, s], t.edge[i, s] + bottom)
                    high[i, s] = min(high[i, s], t.edge[i, s] + top)
                    if low[i, s] <= high[i, s]:
                        masks[i] |= 1 << s
                    else:
                        low[i, s], high[i, s] = math.inf, -math.inf
    relaxed = np.empty_like(t.relaxed)
    for a in range(t.targets.shape[0]):
        relax(low, high, t.targets[a], penalty, t.weights, relaxed[a])
    return Tick(low, high, masks, penalty, relaxed)


@compiled
def remember(t: Tables, memory: Memory, force: NDArray[np.float64], subset: NDArray[np.int8]) -> None:
    """Make an answer the previous one.

    Args:
        t: of the allocator.
        memory: changed in place.
        force: (m,) [N].
        subset: (m,).
    """
    for i in range(force.shape[0]):
        memory.subset[i] = subset[i]
        if subset[i] != 0:
            memory.push[i] = subset[i]
        memory.travel[i] = force[i] - t.edge[i, subset[i] + 1]
