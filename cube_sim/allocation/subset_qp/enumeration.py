"""The report's own algorithm (section 4.3): one ProxQP per subset of thruster sides, the cheapest answer wins."""

from __future__ import annotations

import itertools
import os

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp

from cube_sim.allocation.exact.minimum_cost import nearest_allowed
from cube_sim.allocation.exact.origins import attainable_origin
from cube_sim.allocation.exact.problem import AllocationProblem, ClosestWrenchData
from cube_sim.allocation.exact.solve import answer_of, write_wrench
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
from cube_sim.allocation.exact.step import PreviousAnswer, StepLimits, step_limits, store_answer
from cube_sim.allocation.subset_qp.problem import SubsetQP, subset_qp
from cube_sim.allocation.subset_qp.solver import SubsetSolver, new_qp, settle

OUTER_ITERATIONS = 30
"""Limit for one subset's ProxQP. Most subsets are infeasible and all of those run into it. Of 13,586 live ones, 13,529
took at most 24; 56 had come within rounding of their solution at the limit, and one was lost."""


def every_subset(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.int8]:
    """All choices of one non-empty side per thruster, as rows of -1, 0, +1; forward sides first.

    Args:
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
    """
    open_sides = [[s - 1 for s in (2, 1, 0) if low[i, s] <= high[i, s]] for i in range(len(low))]
    return np.array(list(itertools.product(*open_sides)), dtype=np.int8).reshape(-1, len(low))


class Enumeration:
    """Every subset solved by ProxQP. Slow on purpose: it is the reference the exact search is measured against.

    Args:
        problem: of the allocator.
        closest: of the allocator, with facets where a demand may give way.
        parallel: solve the subsets as one batch over the processor's cores.
    """

    def __init__(self, problem: AllocationProblem, closest: ClosestWrenchData, parallel: bool) -> None:
        self._problem, self._closest, self._parallel = problem, closest, parallel
        self._solver = SubsetSolver(problem.weights, problem.solutions.equations, OUTER_ITERATIONS)

    def allocate(
        self,
        previous: NDArray[np.float64],
        demands: NDArray[np.float64],
        row: NDArray[np.float64],
    ) -> int:
        """Answer one demand into ``row``, see `answer_of`; returns the number of ProxQPs solved.

        Args:
            previous: (6, m) rows of a `PreviousAnswer`, changed in place.
            demands: (n,), or (2 n,) for one of two parts.
            row: (`answer_size`,) out.
        """
        problem, before = self._problem, PreviousAnswer(*previous)
        n, m = problem.A.shape
        two_parts = len(demands) > n
        demand, origin = Demand(*np.empty((4, n))), np.empty((1, m))
        valid = read_demand(demands, 0, two_parts, demand)
        limits = step_limits(problem, before)
        answers, status, solved, proven = [], EXACT, 0, True
        for stage in range(STAGES):
            origins, count, sure = origin, 0, True
            if stage == EXACTLY:
                t = problem
                count = int(attainable_origin(t.solutions, t.largest_wrench, t.tolerance, demand.whole, origin[0]))
            else:
                origins, count, status, _, sure = origins_of_stage(
                    stage, status, problem, self._closest, limits, demand, valid, two_parts, origin
                )
            proven = proven and sure
            for there in origins[:count]:
                answer, more = self._minimum_cost(limits, there)
                solved += more
                if answer is None and stage == NEAREST:
                    answer = self._nearest(limits, there)
                if answer is not None:
                    answers.append(answer)
            if answers and stage != EXACTLY:
                solved += self._add_cheaper_within_rounding(answers, limits, origins)
            if answers:
                break
        cost, force, subset, alternative = min(answers, key=lambda answer: round(answer[0] / problem.tolerance))
        answer = answer_of.py_func(row, n, m)
        answer.force[:], answer.subset[:] = force + 0.0, subset
        write_wrench(problem.A, problem.error_scale, demand.whole, answer)
        answer.rest[1:4] = cost, final_status(status, valid, proven), alternative
        store_answer(problem.edge, before, answer.force, answer.subset)
        return solved

    def _add_cheaper_within_rounding(self, answers: list, limits: StepLimits, origins: NDArray[np.float64]) -> int:
        """Add what only the rounding of A makes dearer, where it saves enough; return the ProxQPs it took."""
        most, solved = (1.0 - WORTHWHILE) * min(answer[0] for answer in answers), 0
        for there in origins:
            answer, more = self._minimum_cost(limits, there, 2.0 * self._problem.hidden)  # twice, as the searches do
            solved += more
            if answer is not None and answer[0] <= most:
                answers.append(answer)
        return solved

    def _minimum_cost(self, limits: StepLimits, origin: NDArray[np.float64], beyond: float = 0.0):
        """(cost, force, subset, alternative) of the best subset, None when none is live, and the ProxQPs it took.

        Forces may lie as much as ``beyond`` [N] off their intervals, and count as the ends of these.
        """
        problem = self._problem
        thrusters = np.arange(len(origin))
        best, winner, solved = np.inf, None, 0
        for alternative, target in enumerate(problem.targets):
            subsets = every_subset(limits.low, limits.high)
            equations, weights = problem.solutions.equations, problem.weights
            low, high = limits.low - beyond, limits.high + beyond
            problems = [subset_qp(subset, origin, equations, low, high, target, weights) for subset in subsets]
            solved += len(problems)
            solutions = solve_in_parallel(problems) if self._parallel else map(self._solver.solve, problems)
            for subset, qp, solution in zip(subsets, problems, solutions, strict=True):
                if not solution.trusted:
                    continue
                at = thrusters, subset + 1
                force = np.clip(solution.force, limits.low[at], limits.high[at])
                cost = float(weights @ (force - qp.target) ** 2 + limits.penalty[at].sum())
                if cost < best - 1e-9 * abs(best if winner else 0.0):
                    best, winner = cost, (cost, force, subset, alternative)
        return winner, solved

    def _nearest(self, limits: StepLimits, origin: NDArray[np.float64]):
        """The same of the allowed forces nearest to some (m,) [N]."""
        force, subset = np.empty(len(origin)), np.empty(len(origin))
        cost, alternative = nearest_allowed(limits, origin, force, subset)
        return cost, force, subset, alternative


def solve_in_parallel(problems: list[SubsetQP]):
    """Solve problems with ProxQP's batch over all cores; one `Solution` per problem, in order."""
    batch = proxqp.dense.BatchQP(len(problems))
    rows, thrusters = problems[0].equations.shape
    for problem in problems:
        qp = batch.init_qp_in_place(thrusters, rows, thrusters)
        new_qp(qp, problem.weight, problem.equations, OUTER_ITERATIONS, problem)
    # Left to itself, ProxQP uses half of the cores.
    proxqp.dense.solve_in_parallel(qps=batch, num_threads=os.cpu_count() or 1)
    return [settle(batch.get(i), problem) for i, problem in enumerate(problems)]
