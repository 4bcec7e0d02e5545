"""Under a change limit: the way to a wrench that takes several calls.

With dead zones the forces in reach of one call are no convex set. The closest wrench among them may be closer than all
that the next call can reach, though some calls farther on the demand itself is made. Who takes the closest wrench at
every call is caught there for ever, one thruster kept from crossing its dead zone by the others::

    |A f - F|   .                          .
                 .        barrier         .
                  .      .        .      .
                   .    .           .   .
                    caught           the wrench that is attainable without a limit
                 |<--->|<--->|<--->|  calls

The number of calls until the wrench is made that would be made without a limit must therefore fall by one at each call.
That it can fall is what the number means. Among the answers that let it fall the closest wrench is made. Where the
closest wrench in reach of all is one of them, it is the answer, as if there were no such condition. So a demand that
stays is made after the fewest calls possible.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.minimum_cost import minimum_cost_forces
from cube_sim.allocation.exact.origins import attainable_origin
from cube_sim.allocation.exact.packing import previous_answer_rows, unpack, unpack_previous_answer, unpack_workspace
from cube_sim.allocation.exact.solve import answer_of, answer_size, solve_each
from cube_sim.allocation.exact.stages import EXACT, UNPROVEN
from cube_sim.allocation.exact.step import HISTORY, REACH, step_limits
from cube_sim.native.compiled import borrowed, compiled

Solved = tuple[float, float, int]
"""Residual [N], cost [N^2] and status of an answer."""

ALMOST = 1e-9
"""Part of a call by which a distance may exceed a whole number of calls, for rounding."""


@compiled
def travel_in_reach(packed: NDArray[np.float64], wrench: NDArray[np.float64], travel: NDArray[np.float64]) -> bool:
    """Find the cheapest forces in reach that make a wrench exactly.

    Args:
        packed: see `pack`; the reach is that of the previous answer in it.
        wrench: (n,) [N], [N m].
        travel: (m,) out: the forces, counted as in `PreviousAnswer` [N].

    Returns:
        Whether there are any.
    """
    packed = borrowed(packed)
    problem, previous, workspace = unpack(packed), unpack_previous_answer(packed), unpack_workspace(packed)
    origin, force, subset = workspace.thrusters[0], workspace.thrusters[1], workspace.thrusters[2]
    there = attainable_origin(problem.solutions, problem.largest_wrench, problem.tolerance, wrench, origin)
    if there:
        there = minimum_cost_forces(
            problem.solutions, problem.plane, problem.planar, step_limits(problem, previous), previous.subset, origin,
            workspace, workspace.thrusters[4:], force, subset, workspace.thrusters[3],
        )[0]  # fmt: skip
    if there:
        for i in range(travel.shape[0]):
            travel[i] = force[i] - problem.edge[i, int(subset[i]) + 1]
    return there


class FewestCalls:
    """Answers with a change limit that bring the wrench of no limit one call nearer.

    Args:
        packed: see `pack`.
        shape: (n, m) of A.
        change_limit: most a force may change in one call [N], finite.
    """

    def __init__(self, packed: NDArray[np.float64], shape: tuple[int, int], change_limit: float) -> None:
        self._packed, self._shape, self._limit = packed, shape, change_limit
        self._rows = previous_answer_rows(packed, shape[1])

    def answer(
        self, demands: NDArray[np.float64], row: NDArray[np.float64], solve: Callable[[], Solved]
    ) -> tuple[Solved, int]:
        """Answer a demand, and make the answer the previous one.

        Args:
            demands: (n,), or (2 n,) for one of two parts.
            row: where `solve` writes its answer.
            solve: answers the demand within the reach of the previous answer, by whatever method.

        Returns:
            The answer, and nodes looked at on the way to it.
        """
        before = self._rows[HISTORY].copy()
        closest, solved = solve(), row.copy()
        if closest[2] in (EXACT, UNPROVEN):
            return closest, 0
        after = self._rows[HISTORY].copy()
        goal, travel, nodes = self._without_limit(before, demands)
        calls, travel = self._fewest_calls(before, goal, travel)
        self._rows[HISTORY] = after
        if calls <= 1 or self._travel(goal, calls - 1) is not None:
            row[:] = solved
        else:
            self._rows[HISTORY] = before
            to_go, later = travel - before[2], (calls - 1) * self._limit
            down = np.minimum(self._limit, later - to_go)
            self._rows[REACH] = down, np.maximum(-down, np.minimum(self._limit, later + to_go))
            closest = solve()
        self._rows[REACH] = self._limit
        return closest, nodes

    def _without_limit(
        self, before: NDArray[np.float64], demands: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
        """The wrench (n,) that would be made without a limit, the travel (m,) [N] of its forces, nodes looked at."""
        n, m = self._shape
        row = np.zeros(answer_size(n, m))
        self._rows[HISTORY], self._rows[REACH] = before, inf
        *_, nodes, _ = solve_each(self._packed, demands, row, np.empty(m, np.int8))
        return answer_of.py_func(row, n, m).wrench.copy(), self._rows[2].copy(), nodes

    def _fewest_calls(
        self, before: NDArray[np.float64], goal: NDArray[np.float64], travel: NDArray[np.float64]
    ) -> tuple[int, NDArray[np.float64]]:
        """Least number of calls from one answer (3, m) to forces that make the goal, and the travel (m,) of these.

        What is reached in some calls is reached in more, so halving finds it.
        """
        self._rows[HISTORY] = before
        too_few, calls = 0, ceil(float(np.abs(travel - before[2]).max()) / self._limit - ALMOST)
        while calls - too_few > 1:
            middle = (too_few + calls) // 2
            nearer = self._travel(goal, middle)
            if nearer is None:
                too_few = middle
            else:
                calls, travel = middle, nearer
        return calls, travel

    def _travel(self, goal: NDArray[np.float64], calls: int) -> NDArray[np.float64] | None:
        """Travel (m,) of forces that make the goal, so many calls from the previous answer; None for none."""
        travel = np.empty(self._shape[1])
        self._rows[REACH] = calls * self._limit
        return travel if travel_in_reach(self._packed, goal, travel) else None
