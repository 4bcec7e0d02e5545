"""The allocators everybody knows: the pseudo-inverse, and the pseudo-inverse cut off at the limits."""

from __future__ import annotations

from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import BaselineModel, flown_by
from cube_sim.allocation.baselines.packing import CLIPPED, PSEUDO_INVERSE
from cube_sim.allocation.baselines.rules import clip
from cube_sim.allocation.flown import FlownAllocator
from cube_sim.allocation.previous import PreviousForces


class PseudoInverse:
    """``f = A^+ F``: least ``|f|^2``, blind to saturation and dead zones unless it is clipped.

    Unclipped forces may lie outside the allowed set; `Status.FORBIDDEN_FORCE` says when. What the thrusters make of
    them is for their characteristic to say: they saturate, and rest in the dead zone. Clipped, each force is cut off at
    saturation. Inside the dead zone it is replaced by what a thruster makes there, 0; where thrusters may not rest, it
    moves to the nearer edge.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        clipped: whether forces keep to the allowed set.
        allow_off: see `Allocator`.
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, *, clipped: bool = False, allow_off: bool = True) -> None:
        self._model = BaselineModel(A, limits, allow_off)
        self._clipped, self._packed = clipped, self._model.packed(CLIPPED if clipped else PSEUDO_INVERSE)

    def reset(self) -> None:
        """Nothing is remembered."""

    def resume(self, previous: PreviousForces) -> None:
        """Nothing is remembered."""

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench (n,)."""
        demand, finite = self._model.demand(wrench)
        asked = self._model.least_squares_forces(demand)
        force = asked.copy()
        if self._clipped:
            clip(self._model.limits, self._model.allow_off, asked, force)
        return self._model.assess(demand, finite, force)

    def flown(self, two_parts: bool) -> FlownAllocator:
        """See `FlownAllocator`."""
        return flown_by(self._packed)

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """Find the forces for the sum of both parts (n,), which this method does not tell apart."""
        return self.allocate(self._model.sum_of_parts(primary, secondary))
