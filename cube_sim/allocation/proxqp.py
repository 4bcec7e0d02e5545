"""Solve a subset's problem with ProxQP, and say whether the answer deserves belief."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp

from cube_sim.allocation.qp import SubsetQP

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
        rows, motors = equations.shape
        self._qp = proxqp.dense.QP(
            motors,
            rows,
            motors,
            False,
            proxqp.dense.HessianType.Diagonal,
            proxqp.dense.DenseBackend.PrimalDualLDLT,
        )
        settings = self._qp.settings
        settings.max_iter, settings.max_iter_in = outer_iterations, 50
        settings.eps_abs, settings.eps_rel = ACCURACY, 0.0
        settings.eps_primal_inf = 0.0
        settings.check_duality_gap = True
        settings.eps_duality_gap_abs, settings.eps_duality_gap_rel = ACCURACY, 0.0
        zero, one = np.zeros(motors), np.ones(motors)
        # No preconditioner: the equations are orthonormal and the intervals are unit rows already.
        self._qp.init(
            np.diag(weight), zero, equations, np.zeros(rows), np.eye(motors), -one, one, compute_preconditioner=False
        )
        # The first solve of a ProxQP object rounds differently from all later ones; spend it here.
        self._qp.solve()

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
        force = np.clip(qp.results.x, problem.low, problem.high)
        trusted = residual(problem, force) <= 10.0 * ACCURACY * (1.0 + float(np.max(np.abs(force))))
        info = qp.results.info
        solved = info.status == proxqp.QPSolverOutput.PROXQP_SOLVED
        return Solution(force, bool(solved and trusted), int(info.iter))


def residual(problem: SubsetQP, force: NDArray[np.float64]) -> float:
    """Largest violation of the problem's equations by ``force`` [N]; NaN never passes a comparison with it."""
    return float(np.max(np.abs(problem.equations @ force - problem.demand), initial=0.0))
