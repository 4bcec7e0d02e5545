"""One allocation after the other, compiled whole: the stages, then wrench, error and what is kept for the next call."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.minimum_cost import cost_on, minimum_cost_forces, nearest_allowed
from cube_sim.allocation.exact.origins import attainable_origin
from cube_sim.allocation.exact.packing import (
    unpack,
    unpack_closest_wrench_data,
    unpack_previous_answer,
    unpack_workspace,
)
from cube_sim.allocation.exact.stages import (
    EXACT,
    EXACTLY,
    NEAREST,
    STAGES,
    WORTHWHILE,
    Demand,
    final_status,
    origins_of_stage,
    read_demand,
)
from cube_sim.allocation.exact.step import step_limits, store_answer, widened
from cube_sim.allocation.exact.ties import count_changes, preferred
from cube_sim.native.compiled import borrowed, compiled, cut

HUGE = 1e300
"""Errors beyond this are all the same [N]; it keeps the residual of the largest demands a number."""


class Answer(NamedTuple):
    """One row of answers, by name.

    Attributes:
        force: (m,) [N].
        wrench: (n,) A f.
        error: (n,) demanded minus achieved.
        subset: (m,) side each thruster is on, -1, 0, +1.
        multiplier: (m,) of the interval ends at the solution of the subset's problem.
        low: (m,) lower end of the side each thruster is on [N].
        high: (m,) upper end of it [N].
        rest: (4,) residual [N], cost [N^2], status, winning alternative of the objective.
    """

    force: NDArray[np.float64]
    wrench: NDArray[np.float64]
    error: NDArray[np.float64]
    subset: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    rest: NDArray[np.float64]


@compiled
def answer_size(rows: int, thrusters: int) -> int:
    """Numbers in one answer; `answer_of` says what is where."""
    return 5 * thrusters + 2 * rows + 4


@compiled
def answer_of(row: NDArray[np.float64], n: int, m: int) -> Answer:
    """Name the parts of one answer."""
    a, b = m + n, m + 2 * n
    return Answer(
        row[:m], row[m:a], row[a:b], row[b : b + m], row[b + m : b + 2 * m], row[b + 2 * m : b + 3 * m],
        row[b + 3 * m : b + 4 * m], row[b + 4 * m :],
    )  # fmt: skip


@compiled
def write_wrench(
    A: NDArray[np.float64], error_scale: NDArray[np.float64], demand: NDArray[np.float64], answer: Answer
) -> None:
    """Write the wrench of the answer's forces, its error against the demand (n,), and the residual."""
    largest = 0.0
    for a in range(demand.shape[0]):
        made = 0.0
        for i in range(A.shape[1]):
            made += A[a, i] * answer.force[i]
        answer.wrench[a], answer.error[a] = made, demand[a] - made
        largest = max(largest, min(abs(answer.error[a] * error_scale[a]), HUGE))
    square = 0.0
    if largest > 0.0:
        for a in range(demand.shape[0]):
            square += (min(abs(answer.error[a] * error_scale[a]), HUGE) / largest) ** 2
    answer.rest[0] = largest * math.sqrt(square)


@compiled
def solve_each(
    packed: NDArray[np.float64],
    demands: NDArray[np.float64],
    answers: NDArray[np.float64],
    subsets: NDArray[np.int8],
) -> tuple[float, float, int, int, int]:
    """Allocate N demands in order, each going on from the answer before.

    A demand that holds a NaN or an infinity counts as zero. One of two parts, ``primary + secondary``, that is not
    attainable yields its secondary part first: the largest share of it is made that is attainable together with the
    primary part. Scaling a demand is the same with a primary part of zero.

    Each stage (see `stages`) names wrenches by one row of forces each, and the cheapest allowed forces that make one of
    them are the answer. In the last stage there always is one: where a rounding leaves no allowed forces that make a
    wrench, the row is moved to the nearest allowed ones. Then all rows are tried once more for what only the rounding
    of A makes dearer.

    Args:
        packed: see `pack`; the previous answer in it is changed.
        demands: (N n,) one after the other [N], [N m]; or (N 2 n,), each primary part followed by its secondary one.
        answers: (N `answer_size`,) out. What is handed over is flat because each view costs a caller time.
        subsets: (N m,) out: the answers' subsets once more, as a caller wants them.

    Returns:
        Residual [N], cost [N^2] and status of the last answer; of all, nodes looked at and answers not proven.
    """
    packed, demands, answers = borrowed(packed), borrowed(demands), borrowed(answers)
    subsets = borrowed(subsets)
    problem, previous, workspace = unpack(packed), unpack_previous_answer(packed), unpack_workspace(packed)
    rows, origin, scratch = workspace.wrenches, workspace.thrusters[:1], workspace.thrusters[4:]
    demand = Demand(rows[0], rows[1], rows[2], rows[3])
    trial, chosen, mu = workspace.thrusters[1], workspace.thrusters[2], workspace.thrusters[3]
    n, m = problem.A.shape
    size = answer_size(n, m)
    calls = answers.shape[0] // size
    two_parts = demands.shape[0] > calls * n
    width = 2 * n if two_parts else n
    residual, final_cost, status, nodes_of_all, doubts = 0.0, 0.0, EXACT, 0, 0
    for at in range(calls):
        answer = answer_of(cut(answers, at * size, (size,), np.float64), n, m)
        valid = read_demand(demands, at * width, two_parts, demand)
        limits = step_limits(problem, previous)
        status, found, best, winner, changes_best, nodes, proven = EXACT, False, math.inf, 0, 0, 0, True
        for stage in range(STAGES):
            origins, count, looked, sure = origin, 0, 0, True
            if stage == EXACTLY:
                count = int(
                    attainable_origin(
                        problem.solutions, problem.largest_wrench, problem.tolerance, demand.whole, origin[0]
                    )
                )
            else:
                closest = unpack_closest_wrench_data(packed)
                origins, count, status, looked, sure = origins_of_stage(
                    stage, status, problem, closest, limits, demand, valid, two_parts, origin
                )
            nodes += looked
            proven = proven and sure
            within, most = limits, math.inf
            for c in range(count if stage == EXACTLY else count + origins.shape[0]):
                again = c >= count
                if c == count:
                    if not found:
                        break
                    within, most = widened(limits, problem.hidden), (1.0 - WORTHWHILE) * best
                there, cost, alternative, looked, sure = minimum_cost_forces(
                    problem.solutions, problem.plane, problem.planar, within, previous.subset,
                    origins[c - count if again else c], workspace, scratch, trial, chosen, mu,
                )  # fmt: skip
                nodes += looked
                proven = proven and (sure or again)
                if not there or cost > most:
                    if stage != NEAREST or again:
                        continue
                    cost, alternative = nearest_allowed(limits, origins[c], trial, chosen)
                    for i in range(m):
                        mu[i] = 0.0
                changes = count_changes(chosen, previous.subset)
                if found and not preferred(cost, best, chosen, answer.subset, changes, changes_best):
                    continue
                found, best, winner, changes_best = True, cost, alternative, changes
                for i in range(m):
                    answer.force[i], answer.subset[i], answer.multiplier[i] = trial[i], chosen[i], mu[i]
            if found:
                break
        status = final_status(status, valid, proven)
        write_wrench(problem.A, problem.error_scale, demand.whole, answer)
        answer.rest[1] = cost_on(limits, winner, answer.force, answer.subset)
        answer.rest[2], answer.rest[3] = status, winner
        for i in range(m):
            s = int(answer.subset[i]) + 1
            answer.low[i], answer.high[i], subsets[at * m + i] = limits.low[i, s], limits.high[i, s], s - 1
        store_answer(problem.edge, previous, answer.force, answer.subset)
        residual, final_cost = answer.rest[0], answer.rest[1]
        nodes_of_all, doubts = nodes_of_all + nodes, doubts + int(not proven)
    return residual, final_cost, status, nodes_of_all, doubts
