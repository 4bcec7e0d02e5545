"""The report's own algorithm (section 4.3): one ProxQP per subset of motor sides, the cheapest answer wins."""

from __future__ import annotations

import itertools
import os

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp

from cube_sim.allocation.exact.minimum_cost import snap
from cube_sim.allocation.exact.origins import attainable_origin, nearest_origins, share_origin
from cube_sim.allocation.exact.problem import Beyond, Tables
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
from cube_sim.allocation.exact.step import Memory, Tick, remember, this_tick
from cube_sim.allocation.subset_qp.problem import SubsetQP, subset_qp
from cube_sim.allocation.subset_qp.solver import SubsetSolver, new_qp, settle

OUTER_ITERATIONS = 30
"""Limit for one subset's ProxQP. Most subsets are infeasible and all of those run into it. Of 13,586 live ones, 13,529
took at most 24; 56 had come within rounding of their solution at the limit, and one was lost."""


def every_subset(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.int8]:
    """All choices of one non-empty side per motor, as rows of -1, 0, +1; forward sides first.

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
        far: of the allocator.
        parallel: solve the subsets as one batch over the processor's cores.
    """

    def __init__(self, tables: Tables, far: Beyond, parallel: bool) -> None:
        self._tables, self._far, self._parallel = tables, far, parallel
        self._solver = SubsetSolver(tables.weights, tables.fibre.equations, OUTER_ITERATIONS)

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
        t, known = self._tables, Memory(*memory)
        n, m = t.A.shape
        primary, secondary = demands[:n], demands[n:]
        two_parts = len(secondary) > 0
        demand = primary + secondary if two_parts else primary
        valid = bool(np.all(np.isfinite(demand)))
        demand = demand if valid else np.zeros(n)
        tick = this_tick(t, known)
        origin, part = np.empty(m), (primary if two_parts and valid else demand).copy()
        status, found, solved, proven = EXACT, None, 0, True
        if attainable_origin(t.fibre, t.reach, t.tolerance, demand, origin):
            found, solved = self._cheapest(tick, origin)
        if found is None:
            status = CLOSEST
        if found is None and valid and (two_parts or t.scaled):
            base, direction = (primary, secondary) if two_parts else (np.zeros(n), demand)
            share, _, proven = share_origin(self._far, t.reach, tick, base, direction, origin, part)
            if share >= 0.0 or not two_parts:
                found, more = self._cheapest(tick, origin)
                solved += more
                status = YIELDED if two_parts else SCALED
        if found is None:
            candidates, _, sure = nearest_origins(t.A, self._far.distance, t.fibre, t.reach, tick, part)
            proven = proven and sure
            answer = []
            for candidate in candidates:
                there, more = self._cheapest(tick, candidate)
                solved += more
                if there is None:
                    force, subset = np.empty(m), np.empty(m)
                    cost, alternative = snap(tick, candidate, force, subset)
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
        remember(t.edge, known, answer.force, answer.subset)
        return solved

    def _cheapest(self, tick: Tick, origin: NDArray[np.float64]):
        """(cost, force, subset, alternative) of the best subset, None when none is live, and the ProxQPs it took."""
        t = self._tables
        motors = np.arange(len(origin))
        best, winner, solved = np.inf, None, 0
        for alternative, target in enumerate(t.targets):
            subsets = every_subset(tick.low, tick.high)
            problems = [
                subset_qp(subset, origin, t.fibre.equations, tick.low, tick.high, target, t.weights)
                for subset in subsets
            ]
            solved += len(problems)
            answers = solve_in_parallel(problems) if self._parallel else map(self._solver.solve, problems)
            for subset, problem, solution in zip(subsets, problems, answers, strict=True):
                if not solution.trusted:
                    continue
                penalty = tick.penalty[motors, subset + 1].sum()
                cost = float(t.weights @ (solution.force - problem.target) ** 2 + penalty)
                if cost < best - 1e-9 * abs(best if winner else 0.0):
                    best, winner = cost, (cost, solution.force, subset, alternative)
        return winner, solved


def solve_in_parallel(problems: list[SubsetQP]):
    """Solve problems with ProxQP's batch over all cores; one `Solution` per problem, in order."""
    batch = proxqp.dense.BatchQP(len(problems))
    rows, motors = problems[0].equations.shape
    for problem in problems:
        qp = batch.init_qp_in_place(motors, rows, motors)
        new_qp(qp, problem.weight, problem.equations, OUTER_ITERATIONS, problem)
    # Left to itself, ProxQP uses half of the cores.
    proxqp.dense.solve_in_parallel(qps=batch, num_threads=os.cpu_count() or 1)
    return [settle(batch.get(i), problem) for i, problem in enumerate(problems)]
