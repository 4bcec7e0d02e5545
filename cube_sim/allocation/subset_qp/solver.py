"""Solve a subset's problem with ProxQP, and say whether the answer deserves belief."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp

from cube_sim.allocation.subset_qp.problem import SubsetQP

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


def residual(problem: SubsetQP, force: NDArray[np.float64]) -> float:
    """Largest violation of the problem's equations by ``force`` [N]; NaN never passes a comparison with it."""
    return float(np.max(np.abs(problem.equations @ force - problem.demand), initial=0.0))
