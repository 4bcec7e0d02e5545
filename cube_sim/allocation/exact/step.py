"""What an allocator keeps from one call to the next, and the limits that follow from it for the next call."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.problem import AllocationProblem
from cube_sim.allocation.exact.relaxation import relax
from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.native.compiled import compiled, inlined


class PreviousAnswer(NamedTuple):
    """The previous answer, and how far the next one may be from it: the rows of one (6, m) array.

    Attributes:
        subset: (m,) its sides, -1, 0, +1: ties prefer them.
        push: (m,) direction each thruster last pushed to, rests passed over: reversals are counted from it.
        travel: (m,) force counted from the edge of the side it lies on [N]. Changes are counted in it: crossing the
            dead zone is no change and is never forbidden.
        held: (m,) calls since each thruster came to the side it is on: prices of leaving it fall with them.
        down: (m,) most ``travel`` may fall by [N]: the change limit, unless `FewestCalls` narrows it. One below 0 is
            what it has to rise by.
        up: (m,) most it may rise by [N], likewise.
    """

    subset: NDArray[np.float64]
    push: NDArray[np.float64]
    travel: NDArray[np.float64]
    held: NDArray[np.float64]
    down: NDArray[np.float64]
    up: NDArray[np.float64]


class StepLimits(NamedTuple):
    """The allowed sides and their costs in one call.

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


HISTORY, REACH = slice(4), slice(4, 6)
"""Which rows of a `PreviousAnswer` say what it was, and which how far the next one may be from it."""


def no_previous_answer(thrusters: int, change_limit: float) -> NDArray[np.float64]:
    """(6, thrusters) rows of a `PreviousAnswer` as at the start of a run: all thrusters at rest."""
    rows = np.zeros((6, thrusters))
    rows[REACH] = change_limit
    return rows


@inlined
def intervals_of(limits: StepLimits, alternative: int) -> SideIntervals:
    """The sides of one alternative of the objective."""
    return SideIntervals(limits.low, limits.high, limits.masks, limits.relaxed[alternative])


@inlined
def side_cost_of(limits: StepLimits, alternative: int) -> SideCost:
    """The costs of one alternative of the objective."""
    return SideCost(limits.weights, limits.targets[alternative], limits.penalty)


@compiled
def step_limits(problem: AllocationProblem, previous: PreviousAnswer) -> StepLimits:
    """Sides and costs of the next call: changes of side cost, and forces may move by the change limit only.

    The price of a change is spread over the time it will last, taken to be as long as the last one has. Staying then
    costs as much as going before it goes, if what is saved stays the same: never more than twice what it would cost who
    knew how long (the ski-rental problem: Karlin, Manasse, Rudolph & Sleator, Algorithmica 3, 1988).

    A side farther away than the change limit is closed. A reversal walks down to the edge of the dead zone, crosses it
    in no time, and walks on from the other edge. A limit smaller than the dead zone therefore slows a thruster down and
    never locks it; that several of them do not lock each other is the matter of `FewestCalls`::

        negative side          dead zone           positive side
        ----------------|                     |----------------
           travel  <----+ edge           edge +---->  travel
    """
    low, high, masks = problem.low, problem.high, problem.masks
    penalty, relaxed = problem.penalty, problem.relaxed
    if problem.reversal_penalty > 0.0 or problem.switching_penalty > 0.0 or problem.change_limit < math.inf:
        low, high, masks, penalty = low.copy(), high.copy(), masks.copy(), penalty.copy()
        for i in range(low.shape[0]):
            share = min(1.0, problem.dwell_calls / max(previous.held[i], 1.0))
            if previous.push[i] != 0.0:
                penalty[i, 1 - int(previous.push[i])] = share * problem.reversal_penalty
            if previous.subset[i] == 0.0:
                penalty[i, 0] += share * problem.switching_penalty
                penalty[i, 2] += share * problem.switching_penalty
            else:
                penalty[i, 1] += share * problem.switching_penalty
            if problem.change_limit < math.inf:
                masks[i] = 0
                for s in range(3):
                    if low[i, s] <= high[i, s]:
                        bottom = problem.edge[i, s] + previous.travel[i] - previous.down[i]
                        top = problem.edge[i, s] + previous.travel[i] + previous.up[i]
                        if bottom - problem.tolerance <= high[i, s] and top + problem.tolerance >= low[i, s]:
                            # What lies exactly one limit away may be reached, whatever the rounding.
                            low[i, s], high[i, s] = (
                                max(low[i, s], min(bottom, high[i, s])),
                                min(high[i, s], max(top, low[i, s])),
                            )
                            masks[i] |= 1 << s
                        else:
                            low[i, s], high[i, s] = math.inf, -math.inf
        relaxed = np.empty_like(relaxed)
        for a in range(problem.targets.shape[0]):
            relax(low, high, problem.targets[a], penalty, problem.weights, relaxed[a])
    return StepLimits(low, high, masks, relaxed, problem.weights, problem.targets, penalty, problem.tolerance)


@inlined
def widened(limits: StepLimits, tolerance: float) -> StepLimits:
    """The same with a larger force that counts as rounding [N]."""
    return StepLimits(
        limits.low, limits.high, limits.masks, limits.relaxed, limits.weights, limits.targets, limits.penalty, tolerance
    )


@compiled
def store_answer(
    edge: NDArray[np.float64], previous: PreviousAnswer, force: NDArray[np.float64], subset: NDArray[np.float64]
) -> None:
    """Make an answer the previous one.

    Args:
        edge: (m, 3) see `AllocationProblem`.
        previous: changed in place.
        force: (m,) [N].
        subset: (m,).
    """
    for i in range(force.shape[0]):
        previous.held[i] = previous.held[i] + 1.0 if subset[i] == previous.subset[i] else 1.0
        previous.subset[i] = subset[i]
        if subset[i] != 0:
            previous.push[i] = subset[i]
        previous.travel[i] = force[i] - edge[i, int(subset[i]) + 1]
