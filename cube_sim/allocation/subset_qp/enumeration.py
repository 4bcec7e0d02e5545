"""The report's own algorithm (section 4.3): one ProxQP per subset of thruster sides, the cheapest answer wins."""

from __future__ import annotations

import itertools
import os

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp

from cube_sim.allocation.exact.minimum_cost import nearest_allowed
from cube_sim.allocation.exact.origins import attainable_origin, nearest_origins, share_origin
from cube_sim.allocation.exact.problem import AllocationProblem, ClosestWrenchData
from cube_sim.allocation.exact.solve import (
    CLOSEST,
    EXACT,
    INVALID_WRENCH,
    SCALED,
    UNPROVEN_CLOSEST,
    YIELDED,
    answer_of,
    complete,
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
        tables: of the allocator.
        closest: of the allocator.
        parallel: solve the subsets as one batch over the processor's cores.
    """

    def __init__(self, tables: AllocationProblem, closest: ClosestWrenchData, parallel: bool) -> None:
        self._tables, self._closest, self._parallel = tables, closest, parallel
        self._solver = SubsetSolver(tables.weights, tables.solutions.equations, OUTER_ITERATIONS)

    def allocate(
        self,
        memory: NDArray[np.float64],
        demands: NDArray[np.float64],
        row: NDArray[np.float64],
    ) -> int:
        """Answer one demand into ``row``, see `answer_of`; returns the number of ProxQPs solved.

        Args:
            memory: (3, m), changed in place.
            demands: (n,), or (2 n,) for one of two parts.
            row: (`answer_size`,) out.
        """
        t, previous = self._tables, PreviousAnswer(*memory)
        n, m = t.A.shape
        primary, secondary = demands[:n], demands[n:]
        two_parts = len(secondary) > 0
        demand = primary + secondary if two_parts else primary
        valid = bool(np.all(np.isfinite(demand)))
        demand = demand if valid else np.zeros(n)
        limits = step_limits(t, previous)
        origin, part = np.empty(m), (primary if two_parts and valid else demand).copy()
        status, found, solved, proven = EXACT, None, 0, True
        if attainable_origin(t.solutions, t.largest_wrench, t.tolerance, demand, origin):
            found, solved = self._minimum_cost(limits, origin)
        if found is None:
            status = CLOSEST
        if found is None and valid and (two_parts or t.scaled):
            base, direction = (primary, secondary) if two_parts else (np.zeros(n), demand)
            share, _, proven = share_origin(self._closest, t.largest_wrench, limits, base, direction, origin, part)
            if share >= 0.0 or not two_parts:
                found, more = self._minimum_cost(limits, origin)
                solved += more
                status = YIELDED if two_parts else SCALED
        if found is None:
            candidates, _, sure = nearest_origins(
                t.A, self._closest.metric, t.solutions, t.largest_wrench, limits, part
            )
            proven = proven and sure
            answer = []
            for candidate in candidates:
                there, more = self._minimum_cost(limits, candidate)
                solved += more
                if there is None:
                    force, subset = np.empty(m), np.empty(m)
                    cost, alternative = nearest_allowed(limits, candidate, force, subset)
                    there = cost, force, subset, alternative
                answer.append(there)
            found = min(answer, key=lambda there: round(there[0] / t.tolerance))
        if not valid:
            status = INVALID_WRENCH
        elif not proven:
            status = UNPROVEN_CLOSEST
        cost, force, subset, alternative = found
        answer = answer_of.py_func(row, n, m)
        answer.force[:], answer.subset[:] = force + 0.0, subset
        complete(t.A, t.error_scale, demand, answer)
        answer.rest[1:4] = cost, status, alternative
        store_answer(t.edge, previous, answer.force, answer.subset)
        return solved

    def _minimum_cost(self, limits: StepLimits, origin: NDArray[np.float64]):
        """(cost, force, subset, alternative) of the best subset, None when none is live, and the ProxQPs it took."""
        t = self._tables
        thrusters = np.arange(len(origin))
        best, winner, solved = np.inf, None, 0
        for alternative, target in enumerate(t.targets):
            subsets = every_subset(limits.low, limits.high)
            problems = [
                subset_qp(subset, origin, t.solutions.equations, limits.low, limits.high, target, t.weights)
                for subset in subsets
            ]
            solved += len(problems)
            answers = solve_in_parallel(problems) if self._parallel else map(self._solver.solve, problems)
            for subset, problem, solution in zip(subsets, problems, answers, strict=True):
                if not solution.trusted:
                    continue
                penalty = limits.penalty[thrusters, subset + 1].sum()
                cost = float(t.weights @ (solution.force - problem.target) ** 2 + penalty)
                if cost < best - 1e-9 * abs(best if winner else 0.0):
                    best, winner = cost, (cost, solution.force, subset, alternative)
        return winner, solved


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
