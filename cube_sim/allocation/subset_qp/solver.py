"""Solve a subset's problem with ProxQP, and say whether the answer deserves belief."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp

from cube_sim.allocation.exact.packing import unpack
from cube_sim.allocation.exact.problem import AllocationProblem
from cube_sim.allocation.exact.solve import EXACT, INVALID_WRENCH, UNPROVEN, answer_of
from cube_sim.allocation.subset_qp.problem import SubsetQP
from cube_sim.native.compiled import borrowed, compiled

BORDER = 1e-6
"""Residuals, part of the largest force, up to which a problem without interior counts as solved."""

ACCURACY = 1e-7
"""Primal and dual residual and duality gap asked of ProxQP [N], [N], [N^2]."""


@dataclass(frozen=True, slots=True)
class Solution:
    """What ProxQP answered.

    Attributes:
        force: (m,) [N], clipped to the subset's box.
        trusted: whether the residuals of ``force``, computed here, are within tolerance.
        iterations: inner iterations taken.
    """

    force: NDArray[np.float64]
    trusted: bool
    iterations: int


class SubsetSolver:
    """ProxQP for the subsets of one vehicle: the weights and equations stay, the intervals and demands change.

    The settings are those that survive infeasible subsets: iterations are capped, infeasibility is never declared
    from a threshold (thin but live subsets would be lost with it), and the duality gap is checked (SOLVED alone can
    hide a large cost error). Every solve starts afresh or from a guess that is passed in, never from the previous
    solve, so that an answer depends on its own problem only, to the last bit.

    The intervals are given as rows of a unit matrix, not as ProxQP's box: a guess has no place for the multipliers
    of a box, and a warm start without them crashes the process (proxsuite 0.8.0).

    Args:
        weight: (m,) w of `SubsetQP`.
        equations: (r, m) of `SubsetQP`.
        outer_iterations: limit that ends an infeasible problem.
    """

    def __init__(
        self, weight: NDArray[np.float64], equations: NDArray[np.float64], outer_iterations: int = 200
    ) -> None:
        rows, thrusters = equations.shape
        self._qp = proxqp.dense.QP(
            thrusters,
            rows,
            thrusters,
            False,
            proxqp.dense.HessianType.Diagonal,
            proxqp.dense.DenseBackend.PrimalDualLDLT,
        )
        new_qp(self._qp, weight, equations, outer_iterations)
        # The first solve of a ProxQP object rounds differently from all later ones; spend it here.
        self._qp.solve()

    def refine(
        self,
        problem: tuple[NDArray, NDArray, NDArray, NDArray],
        guess: tuple[NDArray, NDArray, NDArray],
        scale: float,
    ) -> tuple[bool, NDArray[np.float64]]:
        """Solve from a guess that may be the solution.

        Args:
            problem: (m,) linear cost, (r,) demand, (m,) lower and (m,) upper ends.
            guess: (m,) forces, (r,) multipliers of the equations and (m,) of the intervals.
            scale: largest force there is [N], to which rounding is compared.

        Returns:
            Whether it is solved by ProxQP's own residuals, and (m,) its forces.
        """
        qp = self._qp
        qp.cleanup()
        qp.update(g=problem[0], b=problem[1], l=problem[2], u=problem[3])
        qp.settings.initial_guess = proxqp.InitialGuess.WARM_START
        qp.solve(*guess)
        return solved(qp, scale), qp.results.x

    def solve(self, problem: SubsetQP, guess: tuple[NDArray, NDArray, NDArray] | None = None) -> Solution:
        """Solve one problem.

        Args:
            problem: with the weights and equations the solver was made for.
            guess: optional (m,) forces, (r,) multipliers of the equations and (m,) of the intervals to start from.
        """
        qp, settings = self._qp, self._qp.settings
        qp.cleanup()
        qp.update(g=-problem.weight * problem.target, b=problem.demand, l=problem.low, u=problem.high)
        if guess is None:
            settings.initial_guess = proxqp.InitialGuess.EQUALITY_CONSTRAINED_INITIAL_GUESS
            qp.solve()
        else:
            settings.initial_guess = proxqp.InitialGuess.WARM_START
            qp.solve(*guess)
        return settle(qp, problem)


def new_qp(
    qp: proxqp.dense.QP,
    weight: NDArray[np.float64],
    equations: NDArray[np.float64],
    outer_iterations: int,
    problem: SubsetQP | None = None,
) -> None:
    """Give a ProxQP object its settings and its matrices, and those vectors that are known.

    Args:
        qp: of m variables, r equations and m inequalities.
        weight: (m,).
        equations: (r, m).
        outer_iterations: limit that ends an infeasible problem.
        problem: whose target, demand and intervals to use.
    """
    settings = qp.settings
    settings.max_iter, settings.max_iter_in = outer_iterations, 50
    settings.eps_abs, settings.eps_rel = ACCURACY, 0.0
    settings.eps_primal_inf = 0.0
    settings.check_duality_gap = True
    settings.eps_duality_gap_abs, settings.eps_duality_gap_rel = ACCURACY, 0.0
    rows, thrusters = equations.shape
    g, b, low, high = np.zeros(thrusters), np.zeros(rows), -np.ones(thrusters), np.ones(thrusters)
    if problem is not None:
        g, b, low, high = -problem.weight * problem.target, problem.demand, problem.low, problem.high
    # No preconditioner: the equations are orthonormal and the intervals are unit rows already.
    qp.init(np.diag(weight), g, equations, b, np.eye(thrusters), low, high, compute_preconditioner=False)


def settle(qp: proxqp.dense.QP, problem: SubsetQP) -> Solution:
    """Read a solved ProxQP object, and judge its answer by residuals computed here."""
    force = np.clip(qp.results.x, problem.low, problem.high)
    scale = max(float(np.max(np.abs(problem.low))), float(np.max(np.abs(problem.high))))
    trusted = residual(problem, force) <= max(BORDER * scale, ACCURACY)
    return Solution(force, bool(trusted and solved(qp, scale)), int(qp.results.info.iter))


def solved(qp: proxqp.dense.QP, scale: float) -> bool:
    """Whether a ProxQP object has its answer, by its own residuals.

    One in 200 live subsets keeps residuals a little above the accuracy asked for however long it iterates, so that
    rounding next to the largest force, ``scale`` [N], is accepted too.
    """
    info = qp.results.info
    return bool(
        info.status == proxqp.QPSolverOutput.PROXQP_SOLVED
        or (info.pri_res <= BORDER * scale and info.dua_res <= BORDER and abs(info.duality_gap) <= BORDER * scale**2)
    )


class Confirmer:
    """ProxQP as the second opinion on the search: it solves the chosen subset from the search's own solution.

    A right solution is the fixed point of a warm-started ProxQP, a wrong one is not, so this costs one solve of an
    iteration or two. What it confirms is the search's force, exact to rounding. ProxQP's own last bits depend on
    where its memory happens to lie and would make two runs of one scenario differ.

    Args:
        tables: of the allocator.
        packed: the same, packed.
        agreement: largest difference of the two that counts as agreement, part of ``scale``.
        scale: largest force there is [N].
    """

    def __init__(self, tables: AllocationProblem, packed: NDArray[np.float64], agreement: float, scale: float) -> None:
        rows, thrusters = tables.solutions.equations.shape
        self._packed, self._agreement_N, self._scale = packed, agreement * scale, scale
        self._solver = SubsetSolver(tables.weights, tables.solutions.equations)
        self._problem = np.zeros((6, max(rows, thrusters)))
        self._vectors = tuple(
            self._problem[i, :size] for i, size in enumerate([thrusters, rows, thrusters, thrusters, thrusters])
        )
        self._duals, self._multiplier = self._problem[5, :rows], np.zeros(thrusters)

    def confirms(self, row: NDArray[np.float64], wrench: NDArray[np.float64]) -> bool:
        """Whether ProxQP solves the subset of the one answer and finds the same forces.

        Args:
            row: one answer, see `answer_of`.
            wrench: (n,) demand it answers.
        """
        subset_problem(self._packed, row, wrench, self._problem, self._multiplier)
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
    problem: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> None:
    """Write the chosen subset's problem and its solution.

    Args:
        packed: see `pack`.
        row: one answer, see `answer_of`.
        wrench: (n,) the demand.
        problem: (6, max(r, m)) out, one row each, filled from the left: linear cost (m,), demand (r,), lower ends (m,),
            upper ends (m,), forces (m,), multipliers of the equations (r,).
        multiplier: (m,) out: of the intervals.
    """
    t = unpack(borrowed(packed))
    equations, particular = t.solutions.equations, t.solutions.particular
    rows, thrusters = equations.shape
    answer = answer_of(borrowed(row), t.A.shape[0], thrusters)
    made = np.empty(thrusters)
    status = int(answer.rest[2])
    met = status == EXACT or status == UNPROVEN or status == INVALID_WRENCH  # a tuple compiles slower
    for i in range(thrusters):
        target = t.targets[int(answer.rest[3]), i, int(answer.subset[i]) + 1]
        problem[0, i] = -t.weights[i] * target
        problem[2, i], problem[3, i] = answer.low[i], answer.high[i]
        problem[4, i], multiplier[i] = answer.force[i], answer.multiplier[i]
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
            dual -= equations[b, i] * (t.weights[i] * answer.force[i] + problem[0, i] + multiplier[i])
        problem[1, b], problem[5, b] = demand, dual


@compiled
def within(x: NDArray[np.float64], y: NDArray[np.float64], limit: float) -> bool:
    """Whether no entry differs by more than the limit; a NaN differs from everything."""
    agree = True
    for i in range(x.shape[0]):
        agree = agree and abs(x[i] - y[i]) <= limit
    return agree


def residual(problem: SubsetQP, force: NDArray[np.float64]) -> float:
    """Largest violation of the problem's equations by ``force`` [N]; NaN never passes a comparison with it."""
    return float(np.max(np.abs(problem.equations @ force - problem.demand), initial=0.0))
