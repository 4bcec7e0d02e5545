"""What the baselines have in common: the vehicle as they see it, and an assessment of their forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation, Status
from cube_sim.allocation.baselines.packing import pack_baseline
from cube_sim.allocation.baselines.rules import assess, least_squares
from cube_sim.allocation.exact.solutions import force_solutions
from cube_sim.allocation.flown import FlownAllocator
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import flag, numbers
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import effective_matrix, lever_arm

EXACT_N = 1e-6
"""Residual up to which a wrench counts as made, part of the largest limit."""

NO_FORCE = 1e-12
"""Force that counts as none asked for, part of the largest limit."""


class BaselineModel:
    """The vehicle as the baselines see it: its pseudo-inverse, its limits, and what forces are worth.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: see `Allocator`.

    Attributes:
        A: (n, m).
        limits: (m, 4) [N].
        allow_off: whether a thruster may rest at zero inside its dead zone.
        kernel: (m, k) orthonormal basis of ker A.
        length_m: rms lever arm of A [m].
        rounding_N: force that counts as none asked for [N].

    Raises:
        AllocationError: an argument has the wrong shape, is not finite, or means nothing.
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, allow_off: bool) -> None:
        self.A = effective_matrix(A)
        m = self.A.shape[1]
        self.limits = thruster_limits(limits, m)
        self.allow_off = flag("allow_off", allow_off)
        self.length_m = lever_arm(self.A, axes_of(len(self.A)))
        solutions = force_solutions(self.A, np.ones(m), self.length_m)
        self._pseudo_inverse, self.kernel = solutions.particular, solutions.null_space
        largest = float(np.max(np.abs(self.limits)))
        self._tolerance_N, self.rounding_N = EXACT_N * max(largest, 1e-6), NO_FORCE * largest

    def demand(self, wrench: ArrayLike) -> tuple[NDArray[np.float64], bool]:
        """The demanded wrench (n,), zeros in place of one that is not finite, and whether it was finite.

        Raises:
            AllocationError: the wrench is not n numbers.
        """
        demand = numbers("the wrench", wrench, "vector")
        if demand.shape != (len(self.A),):
            raise AllocationError(f"the wrench has shape {demand.shape}; A has {len(self.A)} rows")
        finite = bool(np.all(np.isfinite(demand)))
        return (demand if finite else np.zeros(len(demand))), finite

    def sum_of_parts(self, primary: ArrayLike, secondary: ArrayLike) -> NDArray[np.float64]:
        """A demand (n,) of two parts as one: no baseline tells them apart.

        Raises:
            AllocationError: a part is not n numbers.
        """
        parts = [numbers("the wrench", part, "vector") for part in (primary, secondary)]
        for part in parts:
            if part.shape != (len(self.A),):
                raise AllocationError(f"the wrench has shape {part.shape}; A has {len(self.A)} rows")
        with np.errstate(over="ignore", invalid="ignore"):  # a sum that is no number is answered as such
            return parts[0] + parts[1]

    def least_squares_forces(self, demand: NDArray[np.float64]) -> NDArray[np.float64]:
        """``A^+ F`` (m,) [N], the forces of least sum of squares that make a demand F (n,), whatever the limits."""
        asked = np.empty(self.A.shape[1])
        least_squares(self._pseudo_inverse, demand, asked)
        return asked

    def assess(self, demand: NDArray[np.float64], finite: bool, force: NDArray[np.float64]) -> Allocation:
        """Say what forces are worth against a demand.

        Args:
            demand: (n,) from `demand`.
            finite: likewise.
            force: (m,) [N].
        """
        n, m = self.A.shape
        force, wrench, error, subset = force + 0.0, np.empty(n), np.empty(n), np.empty(m, np.int8)
        told = axes_of(n).forces, self.length_m, self._tolerance_N
        with np.errstate(over="ignore"):
            residual, cost, status = assess(
                self.A, self.limits, self.allow_off, *told, demand, force, wrench, error, subset
            )
        ended = Status(status) if finite else Status.INVALID_WRENCH
        return Allocation(force, wrench, error, float(residual), float(cost), subset, ended)

    def packed(self, rule: int, regime: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """All that the loop of a flight answers by, see `pack_baseline`; a rule without a regime has none."""
        n, m = self.A.shape
        numbers = self.allow_off, axes_of(n).forces, self.length_m, self._tolerance_N, self.rounding_N
        return pack_baseline(
            rule, self.A, self._pseudo_inverse, self.limits, np.zeros(m) if regime is None else regime, numbers
        )


def flown_by(packed: NDArray[np.float64]) -> FlownAllocator:
    """A baseline as the loop of a flight asks it, by what `BaselineModel.packed` has put together."""
    # Only here: they load the compiler.
    from cube_sim.allocation.baselines.flown import baseline_codes
    from cube_sim.allocation.exact.solve import answer_size

    size = answer_size(int(packed[1]), int(packed[2]))
    return FlownAllocator(packed, baseline_codes, size, lambda *_: None, False, lambda *_: None)
