"""Contraction of the dead zone, the first of the two strategies of Ropars et al. (Ocean Engineering 151, 2018)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import BaselineModel, flown_by
from cube_sim.allocation.baselines.packing import CONTRACTION
from cube_sim.allocation.baselines.rules import contract
from cube_sim.allocation.flown import FlownAllocator
from cube_sim.allocation.previous import PreviousForces


class Contraction:
    """``A^+ F`` with the dead zone cut out of each thruster's axis: forward forces move up by F_DZ+, reverse by F_DZ-.

    The thrusters never work in their dead zone, but every one of them makes more than it was asked for. So the wrench
    is missed by up to ``sum |F_DZ|``, and the controller must make up for it; around zero the forces jump from side
    to side. Ropars shifts commands; a shift of forces is the same on a characteristic that is linear beyond its
    dead zone.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: whether a thruster asked for no force at all rests; else it runs forward at F_DZ+.
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, *, allow_off: bool = True) -> None:
        self._model = BaselineModel(A, limits, allow_off)
        self._packed = self._model.packed(CONTRACTION)

    def reset(self) -> None:
        """Nothing is remembered."""

    def resume(self, previous: PreviousForces) -> None:
        """Nothing is remembered."""

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench (n,)."""
        demand, finite = self._model.demand(wrench)
        asked = self._model.least_squares_forces(demand)
        force = np.empty_like(asked)
        contract(self._model.limits, self._model.allow_off, self._model.rounding_N, asked, force)
        return self._model.assess(demand, finite, force)

    def flown(self, two_parts: bool) -> FlownAllocator:
        """See `FlownAllocator`."""
        return flown_by(self._packed)

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """Find the forces for the sum of both parts (n,), which this method does not tell apart."""
        return self.allocate(self._model.sum_of_parts(primary, secondary))
