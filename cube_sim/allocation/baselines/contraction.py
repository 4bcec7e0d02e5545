"""Contraction of the dead zone, the first of the two strategies of Ropars et al. (Ocean Engineering 151, 2018)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import Judge
from cube_sim.allocation.previous import Standing


class Contraction:
    """``A^+ F`` with the dead zone cut out of every motor's axis: forward forces move up by F_DZ+, reverse by F_DZ-.

    The motors never stand in their dead zone, but every one of them makes more than it was asked for, so the wrench
    is missed by up to ``sum |F_DZ|`` and the controller must make up for it; around zero the forces jump from side
    to side. Ropars shifts commands; a shift of forces is the same on a characteristic that is linear beyond its
    dead zone.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: whether a motor asked for no force at all rests; else it runs forward at F_DZ+.
        power_coefficients: see `Allocator`.
    """

    def __init__(
        self,
        A: ArrayLike,
        limits: ArrayLike,
        *,
        allow_off: bool = True,
        power_coefficients: ArrayLike | None = None,
    ) -> None:
        self._judge = Judge(A, limits, allow_off, power_coefficients)
        self._rounding_N = 1e-12 * float(np.max(np.abs(self._judge.limits)))

    def reset(self) -> None:
        """Nothing is remembered."""

    def resume(self, standing: Standing) -> None:
        """Nothing is remembered."""

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench (n,)."""
        demand, finite = self._judge.demand(wrench)
        low, edge_low, edge_high, high = self._judge.limits.T
        asked = self._judge.least(demand)
        force = np.where(asked < 0.0, asked + edge_low, asked + edge_high)
        if self._judge.allow_off:
            force = np.where(np.abs(asked) <= self._rounding_N, 0.0, force)
        return self._judge.judge(demand, finite, np.clip(force, low, high))
