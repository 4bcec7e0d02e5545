"""ProxQP as the second opinion on the exact search: it must find the same forces on the chosen subset."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.packing import unpack
from cube_sim.allocation.exact.problem import AllocationProblem
from cube_sim.allocation.exact.solve import answer_of
from cube_sim.allocation.exact.stages import EXACT, INVALID_WRENCH, UNPROVEN
from cube_sim.allocation.subset_qp.solver import SubsetSolver
from cube_sim.native import apart
from cube_sim.native.compiled import borrowed, compiled, prepare


class Confirmer:
    """ProxQP as the second opinion on the search: it solves the chosen subset from the search's own solution.

    A right solution is the fixed point of a warm-started ProxQP, a wrong one is not. So this costs one solve of an
    iteration or two. What it confirms is the search's force, exact to rounding. ProxQP's own last bits depend on
    where its memory happens to lie and would make two runs of one scenario differ.

    Args:
        problem: of the allocator.
        packed: the same, packed.
        agreement: largest difference of the two that counts as agreement, part of ``scale``.
        scale: largest force there is [N].
    """

    def __init__(self, problem: AllocationProblem, packed: NDArray[np.float64], agreement: float, scale: float) -> None:
        rows, thrusters = problem.solutions.equations.shape
        self._packed, self._agreement_N, self._scale = packed, agreement * scale, scale
        self._solver = SubsetSolver(problem.weights, problem.solutions.equations)
        self._qp = np.zeros((6, max(rows, thrusters)))
        self._vectors = tuple(
            self._qp[i, :size] for i, size in enumerate([thrusters, rows, thrusters, thrusters, thrusters])
        )
        self._duals, self._multiplier = self._qp[5, :rows], np.zeros(thrusters)

    def confirms(self, row: NDArray[np.float64], wrench: NDArray[np.float64]) -> bool:
        """Whether ProxQP solves the subset of the one answer and finds the same forces.

        Args:
            row: one answer, see `answer_of`.
            wrench: (n,) demand it answers.
        """
        _wait_for_code()
        subset_problem(self._packed, row, wrench, self._qp, self._multiplier)
        linear, demand, low, high, force = self._vectors
        solved, x = self._solver.refine(
            (linear, demand, low, high), (force, self._duals, self._multiplier), self._scale
        )
        return bool(solved and within(x, force, self._agreement_N))


@compiled
def subset_problem(
    packed: NDArray[np.float64],
    row: NDArray[np.float64],
    wrench: NDArray[np.float64],
    qp: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> None:
    """Write the chosen subset's problem and its solution.

    Args:
        packed: see `pack`.
        row: one answer, see `answer_of`.
        wrench: (n,) the demand.
        qp: (6, max(r, m)) out, one row each, filled from the left: linear cost (m,), demand (r,), lower ends (m,),
            upper ends (m,), forces (m,), multipliers of the equations (r,).
        multiplier: (m,) out: of the intervals.
    """
    problem = unpack(borrowed(packed))
    equations, particular = problem.solutions.equations, problem.solutions.particular
    rows, thrusters = equations.shape
    answer = answer_of(borrowed(row), problem.A.shape[0], thrusters)
    made = np.empty(thrusters)
    status = int(answer.rest[2])
    met = status == EXACT or status == UNPROVEN or status == INVALID_WRENCH  # a tuple compiles slower
    for i in range(thrusters):
        target = problem.targets[int(answer.rest[3]), i, int(answer.subset[i]) + 1]
        qp[0, i] = -problem.weights[i] * target
        qp[2, i], qp[3, i] = answer.low[i], answer.high[i]
        qp[4, i], multiplier[i] = answer.force[i], answer.multiplier[i]
        force = answer.force[i]
        if met:
            force = 0.0
            for a in range(wrench.shape[0] if status != INVALID_WRENCH else 0):
                force += particular[i, a] * wrench[a]
        made[i] = force
    for b in range(rows):
        demand, dual = 0.0, 0.0
        for i in range(thrusters):
            demand += equations[b, i] * made[i]
            dual -= equations[b, i] * (problem.weights[i] * answer.force[i] + qp[0, i] + multiplier[i])
        qp[1, b], qp[5, b] = demand, dual


@compiled
def within(x: NDArray[np.float64], y: NDArray[np.float64], limit: float) -> bool:
    """Whether no entry differs by more than the limit; a NaN differs from everything."""
    agree = True
    for i in range(x.shape[0]):
        agree = agree and abs(x[i] - y[i]) <= limit
    return agree


@cache
def _wait_for_code() -> None:
    """Let another process that makes it come to its end: whoever flies is not to load the compiler."""
    apart.finish(CONFIRMATION)


CONFIRMATION = f"{__name__}:make_confirmation"
"""What compiles all that is compiled here, for `cube_sim.native.apart`."""


def make_confirmation() -> None:
    """Have the code of a confirmation."""
    numbers = np.zeros(1)
    prepare(subset_problem, numbers, numbers, numbers, np.zeros((1, 1)), numbers)
    prepare(within, numbers, numbers, 1.0)
