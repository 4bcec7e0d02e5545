"""From a demanded wrench to thruster forces, exactly, dead zones included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.enumeration import OUTER_ITERATIONS, enumerate_subsets
from cube_sim.allocation.geometry import (
    actuation_matrix,
    lever_length,
    torque_rows,
    wrench_distance,
    wrench_fibre,
)
from cube_sim.allocation.limits import side_table, thruster_limits
from cube_sim.allocation.nearest import CANDIDATES, nearest
from cube_sim.allocation.proxqp import SubsetSolver
from cube_sim.allocation.qp import subset_qp
from cube_sim.allocation.relaxation import relax
from cube_sim.allocation.result import Allocation, Status
from cube_sim.allocation.search import FOUND, UNPROVEN, search
from cube_sim.errors import AllocationError

Method = Literal["search+proxqp", "search", "enumerate"]
"""``search+proxqp``: the exact search decides the subset, ProxQP solves it and must agree. ``search``: without ProxQP.
``enumerate``: the report's own algorithm, one ProxQP for each of the 2^m or 3^m subsets."""

Objective = Literal["energy", "target"]
"""``energy``: least ``sum w f^2`` (7). ``target``: closest to a given F_opt (11)."""

AGREEMENT = 1e-4
"""Largest difference between the search's and ProxQP's forces that counts as agreement, part of the largest limit."""

_FAR = 1e6
"""Demands longer than this many times the reach are shortened for the search; the closest wrench is the same."""


@dataclass(slots=True)
class Effort:
    """What allocating has cost so far, for benchmarks and for doubt.

    Attributes:
        nodes: projections solved by the searches.
        qps: problems given to ProxQP.
        disagreements: times ProxQP did not confirm the search.
        unproven: times the search stalled and every subset was enumerated instead.
    """

    nodes: int = 0
    qps: int = 0
    disagreements: int = 0
    unproven: int = 0


class Allocator:
    """Exact dead-zone thruster allocation for one vehicle.

    Minimises ``sum w (f - f_opt)^2`` subject to ``A f = F`` with every f_i in
    ``[F_max-, F_DZ-] u [F_DZ+, F_max+]``, and ``u {0}`` where motors may rest: the global optimum over the union
    of 2^m or 3^m boxes (report section 4.3). A wrench no allowed forces can make is answered by the closest one
    they can, in the norm ``|W (A f - F)|``, exactly over the union as well, and then by the least cost.

    An allocator remembers the subset it answered with: ties prefer it, and the reversal penalty counts against it.
    `reset` forgets it. Nothing else carries over from call to call.

    Args:
        A: (3, m) rows ``[Fx Fy Mz]`` or (6, m) rows ``[Fx Fy Fz Mx My Mz]`` [1], [m].
        limits: (m, 4) rows ``[F_max-, F_DZ-, F_DZ+, F_max+]`` [N], or (m, 2) without dead zones; one row for all.
        allow_off: whether a motor may rest at zero inside its dead zone.
        objective: see `Objective`.
        target: (m,) F_opt [N], required by, and only for, ``target``.
        weights: (m,) positive w of the motors; 1 unless told.
        wrench_weights: (n,) positive diagonal of W, [1] for forces and [1/m] for torques; 1 and 30 unless told: a
            vehicle that keeps its attitude keeps its path, one that saves its forces loses both.
        reversal_penalty: cost of pushing against the side a motor last pushed to [N^2].
        method: see `Method`.
        length_m: divides torques wherever a wrench error is one number; the rms lever arm of A unless told.
        tolerance_N: force that counts as rounding; 1e-9 of the largest limit unless told.

    Raises:
        AllocationError: an argument has the wrong shape, is not finite, or means nothing.
    """

    def __init__(
        self,
        A: ArrayLike,
        limits: ArrayLike,
        *,
        allow_off: bool = True,
        objective: Objective = "energy",
        target: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        wrench_weights: ArrayLike | None = None,
        reversal_penalty: float = 0.0,
        method: Method = "search+proxqp",
        length_m: float | None = None,
        tolerance_N: float | None = None,
    ) -> None:
        self.A = actuation_matrix(A)
        n, m = self.A.shape
        self.limits = thruster_limits(limits, m)
        self.method = _one_of("method", method, get_args(Method))
        self.objective = _one_of("objective", objective, get_args(Objective))
        if (objective == "target") != (target is not None):
            raise AllocationError("objective 'target' and the argument target go together: give both or neither")
        self.target = _row("target", 0.0 if target is None else target, m)
        self.weights = _row("weights", 1.0 if weights is None else weights, m, positive=True)
        attitude_first = np.ones(n)
        attitude_first[torque_rows(n)] = 30.0
        self.wrench_weights = _row(
            "wrench_weights", attitude_first if wrench_weights is None else wrench_weights, n, positive=True
        )
        self.reversal_penalty = float(_row("reversal_penalty", reversal_penalty, 1)[0])
        if self.reversal_penalty < 0.0:
            raise AllocationError(f"reversal_penalty is {reversal_penalty}; it must be >= 0")
        self.length_m = float(
            _row("length_m", lever_length(self.A) if length_m is None else length_m, 1, positive=True)[0]
        )
        largest = float(np.max(np.abs(self.limits)))
        default = max(1e-9 * largest, 1e-12)
        self.tolerance_N = float(
            _row("tolerance_N", default if tolerance_N is None else tolerance_N, 1, positive=True)[0]
        )
        self.effort = Effort()

        self._low, self._high = side_table(self.limits, allow_off)
        self._masks = ((self._low <= self._high) * (1, 2, 4)).sum(axis=1).astype(np.uint8)
        self._fibre = wrench_fibre(self.A, self.weights, self.length_m)
        self._distance = wrench_distance(self.A, self.wrench_weights)
        self._solver = SubsetSolver(self.weights, self._fibre.equations)
        self._enumerator = SubsetSolver(self.weights, self._fibre.equations, OUTER_ITERATIONS)
        self._reach = float(np.max(np.abs(self.A) @ np.max(np.abs(self.limits), axis=1)))
        self._agreement_N = AGREEMENT * max(largest, 1e-6)
        self._side_target = np.ascontiguousarray(np.tile(self.target[:, None], (1, 3)))
        self._relaxed = np.empty((m, 8, 4))
        self.reset()

    def reset(self) -> None:
        """Forget the previous subset, as at the start of a run."""
        m = self.A.shape[1]
        self._previous = np.zeros(m, np.int8)
        self._last_push = np.zeros(m, np.int8)
        self._penalise()

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench.

        Args:
            wrench: (n,) demand [N, N m] in the rows of A.

        Raises:
            AllocationError: the wrench does not have n entries.
        """
        demand = np.array(wrench, dtype=np.float64)
        if demand.shape != (len(self.A),):
            raise AllocationError(f"the wrench has shape {demand.shape}; A has {len(self.A)} rows")
        status = Status.EXACT
        if not np.all(np.isfinite(demand)):
            demand, status = np.zeros(len(self.A)), Status.INVALID_WRENCH
        found = self._exact(demand)
        if found is None:
            found = self._closest(demand)
            status = Status.CLOSEST if status is Status.EXACT else status
        force, subset = found
        answer = self._answer(demand, force, subset, status)
        self._remember(subset)
        return answer

    def _exact(self, demand: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int8]] | None:
        """Forces and subset making the demand at the least cost, None when it is unattainable."""
        far = float(np.max(np.abs(demand)))
        if far > 2.0 * self._reach:
            return None
        outside = self._fibre.unreachable @ demand
        if np.max(np.abs(outside)) > self.tolerance_N:
            return None
        return self._best(self._fibre.particular @ demand)

    def _best(self, origin: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int8]] | None:
        """Least-cost forces making the same wrench as ``origin`` (m,), None when there are none."""
        if self.method == "enumerate":
            return self._enumerate(origin)
        m = len(origin)
        force, multiplier, subset = np.empty(m), np.empty(m), np.empty(m, np.int8)
        outcome, _, nodes = search(
            origin, self._fibre.kernel, self.weights, self._low, self._high, self._side_target, self._penalty,
            self._relaxed, self._masks, self._previous, self.tolerance_N, force, subset, multiplier,
        )  # fmt: skip
        self.effort.nodes += nodes
        if outcome == UNPROVEN:
            self.effort.unproven += 1
            return self._enumerate(origin)
        if outcome != FOUND:
            return None
        if self.method == "search+proxqp":
            self._confirm(origin, force, subset, multiplier)
        at = np.arange(m), subset + 1
        return np.clip(force, self._low[at], self._high[at]), subset

    def _confirm(
        self,
        origin: NDArray[np.float64],
        force: NDArray[np.float64],
        subset: NDArray[np.int8],
        multiplier: NDArray[np.float64],
    ) -> None:
        """Let ProxQP solve the subset from the search's own point, and count it when it does not agree.

        The forces stay the search's: ProxQP's last bit depends on where its buffers happen to lie in memory, and the
        same run has to give the same bytes.
        """
        problem = subset_qp(
            subset, origin, self._fibre.equations, self._low, self._high, self._side_target, self.weights
        )
        gradient = self.weights * (force - problem.target) + multiplier
        self.effort.qps += 1
        solution = self._solver.solve(problem, (force, -problem.equations @ gradient, multiplier))
        if not (solution.trusted and np.max(np.abs(solution.force - force)) <= self._agreement_N):
            self.effort.disagreements += 1

    def _enumerate(self, origin: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int8]] | None:
        sides = self._low, self._high, self._side_target, self._penalty, self.weights
        self.effort.qps += int(np.prod([bin(mask).count("1") for mask in self._masks]))
        return enumerate_subsets(self._enumerator, origin, self._fibre.equations, *sides)

    def _closest(self, demand: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
        """Forces making the closest attainable wrench, of those the cheapest."""
        size = float(np.max(np.abs(demand)))
        limit = _FAR * max(self._reach, 1e-12)
        used = demand * (limit / size) if size > limit else demand
        space = self._distance
        candidates = np.empty((CANDIDATES, self.A.shape[1]))
        count, _, proven, nodes = nearest(
            space.basis.T @ (space.weights * used), space.spread, space.kernel, space.gain,
            self._low, self._high, self._relaxed, self._masks, self.tolerance_N, candidates,
        )  # fmt: skip
        self.effort.nodes += nodes
        self.effort.unproven += not proven
        if count == 0:  # every projection stalled: the nearest sides to the pseudo-inverse are at least allowed
            return self._as_is(self._fibre.particular @ used)
        answers = [self._best(candidate) or self._as_is(candidate) for candidate in candidates[:count]]
        return min(answers, key=lambda answer: round(self._cost(*answer) / self.tolerance_N))

    def _as_is(self, force: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
        """A force vector already on allowed sides, with the subset it lies in."""
        inside = np.maximum(self._low - force[:, None], force[:, None] - self._high)
        subset = (np.argmin(inside, axis=1) - 1).astype(np.int8)
        at = np.arange(len(force)), subset + 1
        return np.clip(force, self._low[at], self._high[at]), subset

    def _cost(self, force: NDArray[np.float64], subset: NDArray[np.int8]) -> float:
        at = np.arange(len(force)), subset + 1
        return float(self.weights @ (force - self._side_target[at]) ** 2 + self._penalty[at].sum())

    def _answer(
        self, demand: NDArray[np.float64], force: NDArray[np.float64], subset: NDArray[np.int8], status: Status
    ) -> Allocation:
        force = force + 0.0
        wrench = self.A @ force
        error = demand - wrench
        scaled = error.copy()
        scaled[torque_rows(len(error))] /= self.length_m
        return Allocation(
            force, wrench, error, float(np.linalg.norm(scaled)), self._cost(force, subset), subset, status
        )

    def _remember(self, subset: NDArray[np.int8]) -> None:
        if np.array_equal(subset, self._previous):
            return
        self._previous = subset.copy()
        if self.reversal_penalty > 0.0:
            self._last_push = np.where(subset != 0, subset, self._last_push)
            self._penalise()

    def _penalise(self) -> None:
        """Price the side opposite to each motor's last push, and retabulate the lower bounds."""
        self._penalty = np.zeros_like(self._low)
        for i, push in enumerate(self._last_push):
            if push != 0:
                self._penalty[i, 1 - push] = self.reversal_penalty
        relax(self._low, self._high, self._side_target, self._penalty, self.weights, self._relaxed)


def _one_of(name: str, value: str, known: Sequence[str]) -> str:
    if value not in known:
        raise AllocationError(f"no {name} {value!r}; there are {', '.join(known)}")
    return value


def _row(name: str, value: ArrayLike, length: int, *, positive: bool = False) -> NDArray[np.float64]:
    """A checked vector; a scalar fills it."""
    try:
        row = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise AllocationError(f"{name} is not a vector of numbers: {error}") from None
    if row.ndim == 0:
        row = np.full(length, row)
    if row.shape != (length,):
        raise AllocationError(f"{name} has shape {row.shape}; it needs ({length},)")
    if not np.all(np.isfinite(row)) or (positive and not np.all(row > 0.0)):
        raise AllocationError(
            f"{name} is {row.tolist()}; every entry must be finite" + (" and > 0" if positive else "")
        )
    return row
