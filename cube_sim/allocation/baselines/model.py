"""What an allocation that only tries its best is worth: the answer of a method without proof, judged."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation, Status
from cube_sim.allocation.allocator import electrical_power
from cube_sim.allocation.exact.solutions import force_solutions
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import flag, numbers, pairs
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import effective_matrix, error_size, lever_arm

EXACT_N = 1e-6
"""Residual up to which a wrench counts as made, part of the largest limit."""


class Judge:
    """The vehicle as the simple allocators see it, and the verdict on their forces.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: see `Allocator`.
        power_coefficients: see `Allocator`.

    Attributes:
        A: (n, m).
        limits: (m, 4) [N].
        kernel: (m, k) orthonormal basis of ker A.
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, allow_off: bool, power_coefficients: ArrayLike | None) -> None:
        self.A = effective_matrix(A)
        m = self.A.shape[1]
        self.limits = thruster_limits(limits, m)
        self.allow_off = flag("allow_off", allow_off)
        self.length_m = lever_arm(self.A, axes_of(len(self.A)))
        solutions = force_solutions(self.A, np.ones(m), self.length_m)
        self._pseudo_inverse, self.kernel = solutions.particular, solutions.null_space
        self.power_coefficients = (
            None if power_coefficients is None else pairs("power_coefficients", power_coefficients, m)
        )
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

    def least(self, demand: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces (m,) of least sum of squares for a demand (n,), bounded by 1e100, so that squares are finite."""
        return self._pseudo_inverse @ np.clip(demand, -1e100, 1e100)

    def judge(self, demand: NDArray[np.float64], finite: bool, force: NDArray[np.float64]) -> Allocation:
        """Say what forces (m,) are worth against a demand (n,)."""
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
        power = None if self.power_coefficients is None else electrical_power(self.power_coefficients, force)
        return Allocation(force, wrench, error, residual, float(force @ force), subset, status, power)
