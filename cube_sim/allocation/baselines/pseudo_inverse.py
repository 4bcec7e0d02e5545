"""The allocators everybody knows: the pseudo-inverse, and the pseudo-inverse cut off at the limits."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import Judge
from cube_sim.allocation.previous import Standing


class PseudoInverse:
    """``f = A^+ F``: least ``|f|^2``, blind to saturation and dead zones unless it is clipped.

    Unclipped forces may lie outside the allowed set; `Status.FORBIDDEN_FORCE` says when. What the motors make of them
    is for their characteristic to say: they saturate, and rest in the dead zone. Clipped, each force is cut off at
    saturation and, inside the dead zone, replaced by what a motor makes, 0; where motors may not rest, it moves to
    the nearer edge.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        clipped: whether forces keep to the allowed set.
        allow_off: see `Allocator`.
        power_coefficients: see `Allocator`.
    """

    def __init__(
        self,
        A: ArrayLike,
        limits: ArrayLike,
        *,
        clipped: bool = False,
        allow_off: bool = True,
        power_coefficients: ArrayLike | None = None,
    ) -> None:
        self._judge = Judge(A, limits, allow_off, power_coefficients)
        self._clipped = clipped

    def reset(self) -> None:
        """Nothing is remembered."""

    def resume(self, standing: Standing) -> None:
        """Nothing is remembered."""

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench (n,)."""
        demand, finite = self._judge.demand(wrench)
        force = self._judge.least(demand)
        if self._clipped:
            low, edge_low, edge_high, high = self._judge.limits.T
            force = np.clip(force, low, high)
            inside = (force > edge_low) & (force < edge_high)
            nearer = np.where(force - edge_low < edge_high - force, edge_low, edge_high)
            force = np.where(inside, 0.0 if self._judge.allow_off else nearer, force)
        return self._judge.judge(demand, finite, force)
