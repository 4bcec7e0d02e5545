"""The report's own algorithm (section 4.3): one ProxQP per subset of motor sides, the cheapest answer wins."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.proxqp import SubsetSolver
from cube_sim.allocation.qp import subset_qp

OUTER_ITERATIONS = 30
"""Limit for one subset's ProxQP. Most subsets are infeasible and all of those run into it; live ones took at most 8."""


def every_subset(low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.int8]:
    """All choices of one non-empty side per motor, as rows of -1, 0, +1; forward sides first.

    Args:
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
    """
    open_sides = [[s - 1 for s in (2, 1, 0) if low[i, s] <= high[i, s]] for i in range(len(low))]
    return np.array(list(itertools.product(*open_sides)), dtype=np.int8).reshape(-1, len(low))


def enumerate_subsets(
    solver: SubsetSolver,
    origin: NDArray[np.float64],
    equations: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    target: NDArray[np.float64],
    penalty: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int8]] | None:
    """Solve every subset's problem, return the forces and subset of least cost, None when no subset can.

    Slow on purpose: 2^m or 3^m solves. It is the reference the exact search is measured against.

    Args:
        solver: for these weights and equations, best with `OUTER_ITERATIONS`.
        origin: (m,) any forces making the demanded wrench [N].
        equations: (r, m) see `SubsetQP`.
        low: (m, 3) lower end of each side [N].
        high: (m, 3) upper end of each side [N].
        target: (m, 3) preferred force on each side [N].
        penalty: (m, 3) cost of choosing each side [N^2].
        weight: (m,).
    """
    motors = np.arange(len(origin))
    best, winner = np.inf, None
    for subset in every_subset(low, high):
        at = motors, subset + 1
        solution = solver.solve(subset_qp(subset, origin, equations, low, high, target, weight))
        if not solution.trusted:
            continue
        cost = float(weight @ (solution.force - target[at]) ** 2 + penalty[at].sum())
        if cost < best - 1e-9 * abs(best if winner else 0.0):
            best, winner = cost, (solution.force, subset)
    return winner
