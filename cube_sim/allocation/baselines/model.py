"""What the baselines have in common: the vehicle as they see it, and an assessment of their forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation, Status
from cube_sim.allocation.exact.solutions import force_solutions
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import flag, numbers
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import effective_matrix, error_size, lever_arm

EXACT_N = 1e-6
"""Residual up to which a wrench counts as made, part of the largest limit."""

LARGEST_DEMAND = 1e100
"""Components of a demand beyond this are all the same [N], [N m]: the squares of the forces stay finite."""


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
        self._tolerance_N = EXACT_N * max(float(np.max(np.abs(self.limits))), 1e-6)

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
        return self._pseudo_inverse @ np.clip(demand, -LARGEST_DEMAND, LARGEST_DEMAND)

    def assess(self, demand: NDArray[np.float64], finite: bool, force: NDArray[np.float64]) -> Allocation:
        """Say what forces are worth against a demand.

        Args:
            demand: (n,) from `demand`.
            finite: likewise.
            force: (m,) [N].
        """
        force = force + 0.0
        wrench = self.A @ force
        error = demand - wrench
        residual = error_size(error, self.length_m)
        resting = np.abs(force) <= self._tolerance_N
        low, edge_low, edge_high, high = self.limits.T + self._tolerance_N * np.array([[-1], [1], [-1], [1]])
        moving = ((force >= low) & (force <= edge_low)) | ((force >= edge_high) & (force <= high))
        allowed = bool(np.all(moving | (resting & self.allow_off)))
        if not finite:
            status = Status.INVALID_WRENCH
        elif not allowed:
            status = Status.FORBIDDEN_FORCE
        else:
            status = Status.EXACT if residual <= self._tolerance_N else Status.MISSED
        subset = np.where(resting & self.allow_off, 0, np.sign(force)).astype(np.int8)
        return Allocation(force, wrench, error, residual, float(force @ force), subset, status)
