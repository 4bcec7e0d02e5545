"""From a demanded wrench to thruster forces, exactly, dead zones included."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import inf
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation, Allocations, Status
from cube_sim.allocation.effort import Effort
from cube_sim.allocation.exact.fewest_calls import FewestCalls, Solved, limited_search_codes, search_codes
from cube_sim.allocation.exact.packing import pack, previous_answer_rows
from cube_sim.allocation.exact.problem import closest_wrench_data, make_problem
from cube_sim.allocation.exact.side_limits import put_limits
from cube_sim.allocation.exact.solutions import force_solutions, wrench_metric
from cube_sim.allocation.exact.solve import answer_size, solve_each
from cube_sim.allocation.exact.step import HISTORY, no_previous_answer
from cube_sim.allocation.flown import FlownAllocator
from cube_sim.allocation.objectives import side_targets
from cube_sim.allocation.options import WEIGHTS_SPAN, Method, Objective, Unattainable
from cube_sim.allocation.previous import PreviousForces
from cube_sim.allocation.subset_qp.confirmations import Confirmations
from cube_sim.allocation.subset_qp.confirmer import Confirmer
from cube_sim.allocation.subset_qp.enumeration import Enumeration
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import comparable, flag, numbers, one_of, row, scalar
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.limits import side_table, thruster_limits
from cube_sim.wrench.matrix import effective_matrix, lever_arm
from cube_sim.wrench.tolerances import FORCE_ROUNDING

AGREEMENT = 1e-4
"""Largest difference between the search's and ProxQP's forces that counts as agreement, part of the largest limit."""

FARTHEST_TARGET = 1e6
"""Most a preferred force may exceed the largest limit: its square is what the forces' differences are seen beside."""

FLOAT, SIDE = np.dtype(np.float64), np.dtype(np.int8)

_STATUS = tuple(Status)


class Allocator:
    """Exact dead-zone thruster allocation for one vehicle.

    Minimises ``sum w (f - f_opt)^2`` subject to ``A f = F`` with every f_i in
    ``[F_max-, F_DZ-] u [F_DZ+, F_max+]``, and ``u {0}`` where thrusters may rest: the global optimum over the union
    of 2^m or 3^m boxes (report section 4.3). A wrench no allowed forces can make is answered by the closest one
    they can, in the norm ``|W (A f - F)|``, exactly over the union as well, and then by the least cost, whereby what
    the rounding of A's entries hides (`MATRIX_ROUNDING` of the largest limit) counts as equally close; or, with
    ``unattainable="scaled"``, by the largest attainable ``scale F`` with 0 < scale < 1. What no forces of any size
    can make is left out of F first. With dead zones the attainable scales have gaps; where none is left but 0, the
    closest wrench is the answer after all.

    An allocator remembers its last answer: ties prefer its subset (but where sides touch at no force, the sign of a
    rounding decides), the reversal penalty and the change limit count
    from it. `reset` forgets it, `resume` replaces it. Nothing else carries over from call to call. One allocator is for
    one thread at a time; several allocators do not disturb each other.

    Args:
        A: (3, m) rows ``[Fx Fy Mz]`` or (6, m) rows ``[Fx Fy Fz Mx My Mz]`` [1], [m].
        limits: (m, 4) rows ``[F_max-, F_DZ-, F_DZ+, F_max+]`` [N], or (m, 2) without dead zones; one row for all.
        allow_off: whether a thruster may rest at zero inside its dead zone.
        objective: see `Objective`.
        target: (m,) F_opt [N], required by, and only for, ``target``.
        reactivity: (m, 2) or (2,) F_react-, F_react+ [N], required by, and only for, the reactivity objectives.
        weights: (m,) positive w of the thrusters, 1e-6 to 1e6 in a ratio of 1e6 at most; 1 unless told.
        wrench_weights: (n,) positive diagonal of W, [1] for forces and [1/m] for torques, likewise; 1 and 30 unless
            told: a vehicle that keeps its attitude keeps its path, one that saves its forces loses both.
        unattainable: see `Unattainable`.
        reversal_penalty: cost of pushing against the side a thruster last pushed to [N^2].
        switching_penalty: cost of a thruster starting from rest or coming to rest [N^2].
        dwell_calls: calls a thruster keeps a side up to which the penalties count in full. From then on they fall in
            proportion: how long a change will last is not known, and is taken to be as long as the last one has. A
            change that saves the same at every call is then made when it would have saved its penalty
            ``dwell_calls`` times. None: they count in full for ever.
        change_limit: most a thruster's force may change in one call [N], the dead zone not counted: a reversal is
            walked through the zone's edges. A small limit delays what is made without one and never locks it: a demand
            that stays is met after the fewest calls possible, see `FewestCalls`. None: no limit.
        method: see `Method`.
        length_m: divides torques wherever a wrench error is one number; the rms lever arm of A unless told.
        tolerance_N: force that counts as rounding, 1e-10 of the largest limit at least; 1e-9 of it unless told.

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
        reactivity: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        wrench_weights: ArrayLike | None = None,
        unattainable: Unattainable = "closest",
        reversal_penalty: float = 0.0,
        switching_penalty: float = 0.0,
        dwell_calls: float | None = None,
        change_limit: float | None = None,
        method: Method = "search+proxqp",
        length_m: float | None = None,
        tolerance_N: float | None = None,
    ) -> None:
        self.A = effective_matrix(A)
        n, m = self.A.shape
        axes = axes_of(n)
        self.limits = thruster_limits(limits, m)
        self.allow_off = flag("allow_off", allow_off)
        self.method = one_of("method", method, get_args(Method))
        self.objective = objective
        targets = side_targets(objective, target, reactivity, m)
        self.weights = row("weights", 1.0 if weights is None else weights, m, positive=True)
        comparable("weights", self.weights, WEIGHTS_SPAN)
        attitude_first = np.ones(n)
        attitude_first[axes.torques] = 30.0
        self.wrench_weights = row(
            "wrench_weights", attitude_first if wrench_weights is None else wrench_weights, n, positive=True
        )
        comparable("wrench_weights", self.wrench_weights, WEIGHTS_SPAN)
        self.unattainable = one_of("unattainable", unattainable, get_args(Unattainable))
        self.reversal_penalty = scalar("reversal_penalty", reversal_penalty)
        self.switching_penalty = scalar("switching_penalty", switching_penalty)
        self.dwell_calls = inf if dwell_calls is None else scalar("dwell_calls", dwell_calls, positive=True)
        self.change_limit = inf if change_limit is None else scalar("change_limit", change_limit, positive=True)
        self.length_m = scalar("length_m", lever_arm(self.A, axes) if length_m is None else length_m, positive=True)
        largest = float(np.max(np.abs(self.limits)))
        default = max(1e-9 * largest, 1e-12)
        self.tolerance_N = scalar("tolerance_N", default if tolerance_N is None else tolerance_N, positive=True)
        if self.tolerance_N < FORCE_ROUNDING * largest:
            raise AllocationError(
                f"tolerance_N is {self.tolerance_N:g}; forces of {largest:g} N need {FORCE_ROUNDING * largest:g} "
                "at least"
            )
        if targets.size and np.max(np.abs(targets)) > FARTHEST_TARGET * max(largest, 1e-30):
            raise AllocationError(
                f"forces of {np.max(np.abs(targets)):g} N are preferred; beyond {FARTHEST_TARGET:g} times the largest "
                f"limit, {largest:g} N, nothing is seen beside them"
            )
        self._effort = Effort()
        preferred = {"target": target, "reactivity": reactivity}
        self._preferred = {name: None if value is None else np.array(value) for name, value in preferred.items()}
        self._problem = make_problem(
            self.A,
            force_solutions(self.A, self.weights, self.length_m),
            side_table(self.limits, self.allow_off),
            self.weights,
            targets,
            reversal_penalty=self.reversal_penalty,
            switching_penalty=self.switching_penalty,
            dwell_calls=self.dwell_calls,
            change_limit=self.change_limit,
            tolerance=self.tolerance_N,
            length_m=self.length_m,
            scaled=self.unattainable == "scaled",
        )
        self._closest = closest_wrench_data(wrench_metric(self.A, self.wrench_weights), facets=self._problem.scaled)
        self._previous = no_previous_answer(m, self.change_limit)
        self._pack()
        self.answer_size, self._ends = answer_size(n, m), (m, m + n, m + 2 * n)
        self._confirmations = (
            Confirmations(Confirmer(self._problem, self._packed, AGREEMENT, max(largest, 1e-6)))
            if self.method == "search+proxqp"
            else None
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are built anew and told what to remember: ProxQP's memory cannot be copied."""
        same = "allow_off", "objective", "weights", "wrench_weights", "unattainable", "reversal_penalty"
        same += "switching_penalty", "method", "length_m", "tolerance_N"
        options = {name: getattr(self, name) for name in same} | self._preferred
        for name in ("dwell_calls", "change_limit"):
            options[name] = None if getattr(self, name) == inf else getattr(self, name)
        return partial(Allocator, **options), (self.A, self.limits), self.memory()

    def __setstate__(self, state: tuple[NDArray[np.float64], Effort]) -> None:
        """Go on from a copy's previous answer (6, m) and effort."""
        self.recall(state)

    @property
    def effort(self) -> Effort:
        """What allocating has cost so far."""
        self.settle()
        return self._effort

    def memory(self) -> tuple[NDArray[np.float64], Effort]:
        """The previous answer (6, m) and the effort so far, for `recall`."""
        return self._previous.copy(), replace(self.effort)

    def recall(self, memory: tuple[NDArray[np.float64], Effort]) -> None:
        """Go on from a memory of this allocator's, or of one of the same arguments."""
        self.settle()
        self._previous[:], effort = memory
        self._effort = replace(effort)

    def _pack(self) -> None:
        """Prepare what answers demands; the previous answer lies in it."""
        self._packed = pack(self._problem, self._closest, self._previous)
        self._previous = previous_answer_rows(self._packed, len(self.limits))
        self._fewest_calls = FewestCalls(self._packed, len(self.limits)) if self.change_limit < inf else None
        parallel = self.method == "enumerate_parallel"
        self._enumeration = (
            Enumeration(self._problem, self._closest, parallel) if self.method.startswith("enumerate") else None
        )

    def limit(self, limits: NDArray[np.float64]) -> bool:
        """Allocate from now on within these limits, going on from the previous answer.

        Args:
            limits: (m, 4) [F_max-, F_DZ-, F_DZ+, F_max+] [N], in that order.

        Returns:
            Whether it does: a method other than the search has to be built anew.
        """
        if self._enumeration is not None:
            return False
        put_limits(self._packed, limits)
        return True

    def reset(self) -> None:
        """Forget the previous answer, as at the start of a run."""
        self._previous[HISTORY] = 0.0

    def resume(self, previous: PreviousForces) -> None:
        """Go on from forces of another allocator's as if they were this one's previous answer.

        Args:
            previous: of the m thrusters. A force outside its side's interval counts as the nearest end of it.
        """
        at = np.arange(len(previous.force)), previous.subset.astype(np.intp) + 1
        t = self._problem
        force = np.clip(previous.force, t.low[at], t.high[at])
        travel = np.where(t.low[at] <= t.high[at], force - t.edge[at], 0.0)
        self._previous[HISTORY] = previous.subset, previous.push, travel, np.ones(len(travel))

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench.

        Args:
            wrench: (n,) demand [N, N m] in the rows of A.

        Raises:
            AllocationError: the wrench is not n numbers.
        """
        demand = self._demand(wrench)
        return self._answer(demand, demand)

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """Find the forces for a demand ``primary + secondary`` whose secondary part gives way.

        Where the sum is not attainable, the answer makes ``primary + share * secondary`` with the largest share in
        [0, 1] at which it is, exactly over the union of all subsets, and of the forces that do the cheapest:
        ``YIELDED``. Dead zones leave gaps between the attainable shares, so that 0 may be none of them while a larger
        one is. Where no share is, the answer is the closest attainable wrench to the primary part alone. What no
        forces of any size can make is left out of both parts first.

        Args:
            primary: (n,) [N, N m].
            secondary: (n,) [N, N m].

        Returns:
            An answer whose ``wrench_error`` and ``residual`` are counted from the sum.

        Raises:
            AllocationError: a part is not n numbers.
        """
        first, second = self._demand(primary), self._demand(secondary)
        self._prepare_for_parts()
        with np.errstate(over="ignore", invalid="ignore"):  # a sum that is no number is answered as such
            whole = first + second
        return self._answer(whole, np.concatenate((first, second)))

    def flown(self, two_parts: bool) -> FlownAllocator | None:
        """What compiled code answers demands by, one at a time; None where the method is another than the search.

        Args:
            two_parts: whether demands have a part that gives way.
        """
        if self._enumeration is not None:
            return None
        if two_parts:
            self._prepare_for_parts()
        codes = search_codes if self._fewest_calls is None else limited_search_codes
        told = self._effort.add, self._confirmations is not None, self.confirm_later, self.go_on_confirming
        return FlownAllocator(self._packed, codes, self.answer_size, *told)

    def confirm_later(self, rows: NDArray[np.float64], demands: NDArray[np.float64]) -> None:
        """Let ProxQP solve the subsets of N answers, where the method says so, when somebody lets it go on.

        Args:
            rows: (N, `answer_size`) answers, see `answer_of`; not to be changed any more.
            demands: (N, n) that they answer, likewise.
        """
        if self._confirmations is not None:
            self._confirmations.later(rows, demands)

    def go_on_confirming(self) -> None:
        """Confirm what waits, many answers at a time, beside what the caller does next."""
        if self._confirmations is not None:
            self._confirmations.go_on()

    def settle(self) -> None:
        """See to it that every answer is confirmed, where the method says so."""
        if self._confirmations is not None:
            asked, refused = self._confirmations.settle()
            self._effort.qps += asked
            self._effort.disagreements += refused

    def _prepare_for_parts(self) -> None:
        """Make ready for demands of two parts."""
        if not len(self._closest.facets):
            self._closest = closest_wrench_data(self._closest.metric, facets=True)
            self._pack()

    def _demand(self, wrench: ArrayLike) -> NDArray[np.float64]:
        """A checked demand (n,)."""
        shape = self.wrench_weights.shape
        # Anything else, a read-only array for one, would be compiled for anew, which takes half a minute.
        if type(wrench) is np.ndarray and wrench.dtype is FLOAT and wrench.flags.carray and wrench.shape == shape:
            return wrench
        demand = numbers("the wrench", wrench, "vector")
        if demand.shape != shape:
            raise AllocationError(f"the wrench has shape {demand.shape}; A has {len(self.A)} rows")
        return demand

    def _answer(self, demand: NDArray[np.float64], demands: NDArray[np.float64]) -> Allocation:
        """Answer one demand (n,) given as it is, or as its two parts (2 n,)."""
        m, a, b = self._ends
        row, subset, effort = np.zeros(self.answer_size), np.empty(m, SIDE), self._effort
        if self._fewest_calls is not None:
            solve = self._search if self._enumeration is None else self._enumerate
            residual, cost, status = self._answer_in_reach(solve, demands, row, subset)
        elif self._enumeration is None:
            residual, cost, status, nodes, doubts = solve_each(self._packed, demands, row, subset)
            effort.add(nodes, doubts)
        else:
            residual, cost, status = self._enumerate(demands, row, subset)
        if self._confirmations is not None:
            self._confirmations.now(row, demand)
        force, status = row[:m], _STATUS[int(status)]
        # A named tuple's own constructor takes longer than the arrays it is given.
        return tuple.__new__(Allocation, (force, row[m:a], row[a:b], residual, cost, subset, status))

    def _search(self, demands: NDArray[np.float64], row: NDArray[np.float64], subset: NDArray[np.int8]) -> Solved:
        """Answer a demand by the search, within the reach of the previous answer."""
        *solved, nodes, doubts = solve_each(self._packed, demands, row, subset)
        self._effort.add(nodes, doubts)
        return tuple(solved)

    def _enumerate(self, demands: NDArray[np.float64], row: NDArray[np.float64], subset: NDArray[np.int8]) -> Solved:
        """The same by every subset."""
        assert self._enumeration is not None
        m, _, b = self._ends
        self._effort.qps += self._enumeration.allocate(self._previous, demands, row)
        subset[:] = row[b : b + m]
        return tuple(row[-4:-1].tolist())

    def _answer_in_reach(
        self,
        solve: Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]], Solved],
        demands: NDArray[np.float64],
        row: NDArray[np.float64],
        subset: NDArray[np.int8],
    ) -> Solved:
        """Answer a demand by one of the two methods, under the change limit."""
        assert self._fewest_calls is not None
        solved, nodes = self._fewest_calls.answer(demands, lambda: solve(demands, row, subset))
        self._effort.nodes += nodes
        subset[:] = row[self._ends[2] : self._ends[2] + len(subset)]
        return solved

    def allocate_many(self, wrenches: ArrayLike) -> Allocations:
        """Find the forces for N demanded wrenches in order, in one compiled call where no change limit is set.

        The answers are those of N calls of `allocate` with the method ``search``, whatever this allocator's method.

        Args:
            wrenches: (N, n) demands [N, N m].

        Raises:
            AllocationError: the demands are not n columns of numbers.
        """
        demands = numbers("the array of wrenches", wrenches, "table")
        n, m = self.A.shape
        if demands.ndim != 2 or demands.shape[1] != n:
            raise AllocationError(f"the wrenches have shape {demands.shape}; A has {n} rows, so give (N, {n})")
        answers, subsets = np.zeros((len(demands), self.answer_size)), np.empty((len(demands), m), SIDE)
        if self._fewest_calls is None:
            self._search(demands.ravel(), answers.ravel(), subsets.ravel())
        else:
            for demand, answer, subset in zip(demands, answers, subsets, strict=True):
                self._answer_in_reach(self._search, demand, answer, subset)
        _, a, b = self._ends
        rest = answers[:, -4:]
        return Allocations(
            answers[:, :m].copy(),
            answers[:, m:a].copy(),
            answers[:, a:b].copy(),
            rest[:, 0].copy(),
            rest[:, 1].copy(),
            subsets,
            rest[:, 2].astype(np.int8),
        )
