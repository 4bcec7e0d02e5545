"""An allocator of the user's own: what it gets, and the `WrenchAllocator` around it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.baselines.model import BaselineModel
from cube_sim.allocation.fault_tolerant import Build
from cube_sim.allocation.previous import PreviousForces
from cube_sim.allocation.protocol import WrenchAllocator
from cube_sim.mission.copying import packed, unpacked
from cube_sim.mission.own.allocation_setup import AllocationSetup
from cube_sim.mission.own.code import OwnCode, numbers_of, require_taken, without
from cube_sim.mission.own.compiled_allocator import CompiledAllocator
from cube_sim.mission.own.compiled_part import CompiledPart
from cube_sim.mission.own.handed import handed
from cube_sim.scenario import Loaded
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.thrusters import Thrusters

METHODS = "allocate", "allocate_by_priority", "reset", "resume"


class OwnAllocator:
    """A function from a wrench (6,) to forces (k,), or a `WrenchAllocator`, whose answers are looked at.

    Args:
        code: where it comes from.
        allocator: it.
        setup: what it was made from.

    Raises:
        OwnCodeError: it is neither.
    """

    def __init__(self, code: OwnCode, allocator: Any, setup: AllocationSetup) -> None:
        self._whole = hasattr(allocator, "allocate")
        if self._whole and (missing := without(allocator, METHODS)):
            raise code.refuse(f"makes a {type(allocator).__name__} without the method {missing}")
        if not self._whole and not callable(allocator):
            made = type(allocator).__name__
            raise code.refuse(f"makes a {made}; it takes a function of a wrench, or an object with allocate")
        self._code, self._count = code, len(setup.which)
        self._allocator: Any = allocator
        self._model = BaselineModel(setup.A, setup.limits, setup.allow_off)

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """See `WrenchAllocator.allocate`."""
        if self._whole:
            return self._checked(self._code.call(self._allocator.allocate, np.array(wrench)))
        demand, finite = self._model.demand(wrench)
        answer = self._code.call(self._allocator, demand.copy())
        return self._model.assess(demand, finite, self._forces(answer))

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """See `WrenchAllocator.allocate_by_priority`; a function gets the sum."""
        if self._whole:
            parts = np.array(primary), np.array(secondary)
            return self._checked(self._code.call(self._allocator.allocate_by_priority, *parts))
        return self.allocate(self._model.sum_of_parts(primary, secondary))

    def reset(self) -> None:
        """See `WrenchAllocator.reset`."""
        if self._whole:
            self._code.call(self._allocator.reset)

    def resume(self, previous: PreviousForces) -> None:
        """See `WrenchAllocator.resume`."""
        if self._whole:
            self._code.call(self._allocator.resume, handed(previous))

    def memory(self) -> bytes:
        """What `recall` needs to go on from here: the allocator as it is."""
        return packed(self._allocator, {})

    def recall(self, memory: bytes) -> None:
        """Go on from a memory."""
        self._allocator = unpacked(memory, {})

    def _checked(self, answer: Any) -> Allocation:
        if not isinstance(answer, Allocation):
            raise self._code.refuse(f"answers a {type(answer).__name__} to allocate; it takes an Allocation")
        numbers_of(self._code, answer.wrench, (6,), "its wrench")
        return handed(answer)._replace(force=self._forces(answer.force))

    def _forces(self, answer: Any) -> Vector:
        return numbers_of(self._code, answer, (self._count,), "forces")


def own_build(loaded: Loaded, code: OwnCode, thrusters: Thrusters) -> Build:
    """What builds the user's allocator for the thrusters that respond.

    Raises:
        ScenarioError: the code cannot be called so; with position.
    """
    allow_off = loaded.scenario.allocation.allow_off

    def build(A: Matrix, limits: Matrix, which: NDArray[np.int_]) -> WrenchAllocator:
        setup = AllocationSetup(A, limits, which, tuple(thrusters.names[i] for i in which), allow_off)
        own = replace(setup, A=A.copy(), limits=limits.copy(), which=which.copy())
        made = code.call(code.make, own, **code.options)
        kind = CompiledAllocator if isinstance(made, CompiledPart) else OwnAllocator
        return kind(code, made, setup)

    require_taken(loaded, code, 1)
    return build
