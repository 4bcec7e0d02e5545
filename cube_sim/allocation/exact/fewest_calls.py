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
from functools import cache
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.code import SEARCHING, search_address
from cube_sim.allocation.exact.minimum_cost import minimum_cost_forces
from cube_sim.allocation.exact.origins import attainable_origin
from cube_sim.allocation.exact.packing import (
    answer_rows,
    previous_answer_rows,
    set_reach,
    unpack,
    unpack_previous_answer,
    unpack_workspace,
)
from cube_sim.allocation.exact.solve import answer_of, answer_size
from cube_sim.allocation.exact.stages import EXACT, UNPROVEN
from cube_sim.allocation.exact.step import HISTORY, REACH, step_limits
from cube_sim.allocation.flown import SearchCodes
from cube_sim.native.callee import Callee, call_at
from cube_sim.native.compiled import borrowed, compiled, cut
from cube_sim.tuples import put, put_matrix

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


_NUMBERS = np.zeros(1)
TRAVELLING = Callee(travel_in_reach, lambda: (_NUMBERS, _NUMBERS, _NUMBERS), answers=np.bool_)


@compiled
def travel_in_calls(code, packed, goal, calls, limit, travel):
    """`travel_in_reach` of so many calls from the previous answer.

    Args:
        code: address of that of `travel_in_reach`.
        packed: see `pack`; its reach is changed.
        goal: (n,) wrench [N], [N m].
        calls: how many.
        limit: most a force may change in one call [N].
        travel: (m,) out [N].
    """
    set_reach(packed, calls * limit)
    return call_at(TRAVELLING, code, (packed, goal, travel))


@compiled
def narrow_reach(search, travel_code, packed, demands, before):
    """Let the next answer bring the wrench of no limit one call nearer, where the closest one in reach does not.

    Args:
        search: address of the code of `solve_each`.
        travel_code: of `travel_in_reach`.
        packed: see `pack`; the closest answer in reach is the previous one in it. Where another has to be looked for it
            is that of the call before, and the reach a narrower one. Otherwise only the reach is changed.
        demands: (n,), or (2 n,) for one of two parts.
        before: (4, m) rows `HISTORY` before that answer.

    Returns:
        Whether another answer has to be looked for, and nodes looked at.
    """
    rows, limit = answer_rows(packed), unpack(packed).change_limit
    m = rows.shape[1]
    n = cut(packed, 0, (1,), np.int64)[0]
    after, row, sides = np.empty((4, m)), np.zeros(answer_size(n, m)), np.empty(m, np.int8)
    put_matrix(after, rows[:4])
    put_matrix(rows[:4], before)
    set_reach(packed, inf)
    _, _, _, nodes, _ = call_at(SEARCHING, search, (packed, demands, row, sides))
    goal, travel, nearer = answer_of(row, n, m).wrench, np.empty(m), np.empty(m)
    put(travel, rows[2])
    # Least number of calls to forces that make the goal: what is reached in some calls is reached in more.
    put_matrix(rows[:4], before)
    farthest = 0.0
    for i in range(m):
        farthest = max(farthest, abs(travel[i] - before[2, i]))
    too_few, calls = 0, ceil(farthest / limit - ALMOST)
    while calls - too_few > 1:
        middle = (too_few + calls) // 2
        if travel_in_calls(travel_code, packed, goal, middle, limit, nearer):
            calls = middle
            put(travel, nearer)
        else:
            too_few = middle
    put_matrix(rows[:4], after)
    if calls <= 1 or travel_in_calls(travel_code, packed, goal, calls - 1, limit, nearer):
        return False, nodes
    put_matrix(rows[:4], before)
    for i in range(m):
        to_go, later = travel[i] - before[2, i], (calls - 1) * limit
        rows[4, i] = min(limit, later - to_go)
        rows[5, i] = max(-rows[4, i], min(limit, later + to_go))
    return True, nodes


@compiled
def solve_in_reach(search, travel_code, packed, demands, row, sides, effort):
    """`solve_each` of one demand under a change limit; see `FewestCalls`.

    Args:
        search: address of the code of `solve_each`.
        travel_code: of `travel_in_reach`.
        packed: see `pack`; the previous answer in it is changed.
        demands: (n,), or (2 n,) for one of two parts.
        row: of `answer_of`, out.
        sides: (m,) out.
        effort: (2,) nodes looked at and answers not proven, counted on.
    """
    rows = answer_rows(packed)
    before = np.empty((4, rows.shape[1]))
    put_matrix(before, rows[:4])
    _, _, status, nodes, doubts = call_at(SEARCHING, search, (packed, demands, row, sides))
    effort[0] += nodes
    effort[1] += doubts
    if status in (EXACT, UNPROVEN):
        return
    again, nodes = narrow_reach(search, travel_code, packed, demands, before)
    effort[0] += nodes
    if again:
        _, _, _, nodes, doubts = call_at(SEARCHING, search, (packed, demands, row, sides))
        effort[0] += nodes
        effort[1] += doubts
    set_reach(packed, unpack(packed).change_limit)


INSTEAD = Callee(
    solve_in_reach, lambda: (0, 0, _NUMBERS, _NUMBERS, _NUMBERS, np.zeros(1, np.int8), np.zeros(2, np.int64))
)
"""What answers in the place of `solve_each`: this, or a baseline."""


def search_codes() -> SearchCodes:
    """Where the code lies that answers demands without a change limit."""
    return SearchCodes(search_address(), 0, 0)


@cache
def limited_search_codes() -> SearchCodes:
    """Where all code lies that answers demands under a change limit; it is compiled only for those who set one."""
    return SearchCodes(search_address(), INSTEAD.address(), TRAVELLING.address())


class FewestCalls:
    """Answers with a change limit that bring the wrench of no limit one call nearer, by whatever method.

    Args:
        packed: see `pack`, of a problem with a change limit.
        thrusters: m.
    """

    def __init__(self, packed: NDArray[np.float64], thrusters: int) -> None:
        self._packed, self._rows = packed, previous_answer_rows(packed, thrusters)

    def answer(self, demands: NDArray[np.float64], solve: Callable[[], Solved]) -> tuple[Solved, int]:
        """Answer a demand, and make the answer the previous one.

        Args:
            demands: (n,), or (2 n,) for one of two parts.
            solve: answers the demand within the reach of the previous answer.

        Returns:
            The answer, and nodes looked at on the way to it.
        """
        before, limit = self._rows[HISTORY].copy(), self._rows[REACH].copy()
        closest = solve()
        if closest[2] in (EXACT, UNPROVEN):
            return closest, 0
        codes = limited_search_codes()
        again, nodes = narrow_reach(codes.search, codes.travel, self._packed, demands, before)
        if again:
            closest = solve()
        self._rows[REACH] = limit
        return closest, nodes
