"""The thrusters as a controller uses them: those believed to work, allocated exactly, faults taken off the demand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation import Allocation, Allocator, Status
from cube_sim.allocation.factory import WrenchAllocator
from cube_sim.control.health import Health
from cube_sim.spatial import Matrix, Vector

Build = Callable[[Matrix, Matrix, NDArray[np.int_]], WrenchAllocator]
"""(A (6,k), limits (k,4), which thrusters (k,)) -> an allocator for k thrusters."""


class Actuators:
    """An allocator over the thrusters that obey, rebuilt whenever the belief about them changes.

    A dead thruster's column is dropped; a weak one keeps its column with its limits scaled; a stuck one's wrench is
    taken off every demand.

    Args:
        A: (6,m) actuation matrix, as believed.
        limits: (m,4) [N] of whole thrusters.
        build: makes the allocator.
    """

    def __init__(self, A: Matrix, limits: Matrix, build: Build) -> None:
        self.matrix, self._limits, self._build = A, limits, build
        self.believe(Health.whole(A.shape[1]))

    def believe(self, health: Health) -> None:
        """Allocate from now on for thrusters in this state."""
        self.health = health
        self._obedient = np.flatnonzero(health.obedient)
        self._held = np.where(np.isnan(health.stuck), 0.0, health.stuck)
        efficiency = health.efficiency[self._obedient, None]
        self._allocator = (
            self._build(self.matrix[:, self._obedient], self._limits[self._obedient] * efficiency, self._obedient)
            if self._obedient.size
            else None
        )

    @property
    def count(self) -> int:
        """m, dead and stuck ones included."""
        return len(self._limits)

    @property
    def working_matrix(self) -> Matrix:
        """(6,k) columns of the thrusters that obey."""
        return self.matrix[:, self._obedient]

    def allocate(self, wrench: Vector, secondary: Vector | None = None) -> Allocation:
        """Forces (m,) of all thrusters for a demand (6,): dead ones 0, stuck ones what they hold.

        Args:
            wrench: all that is demanded [N, N m].
            secondary: the part (6,) of it that gives way to the rest, to an allocator that knows parts; None for none.
        """
        held = self.matrix @ self._held
        m = self.matrix.shape[1]
        if self._allocator is None:
            error = wrench - held
            still = np.zeros(m, np.int8)
            return Allocation(self._held.copy(), held, error, float(np.linalg.norm(error)), 0.0, still, Status.CLOSEST)
        if secondary is not None and secondary.any() and isinstance(self._allocator, Allocator):
            part = self._allocator.allocate_by_priority(wrench - held - secondary, secondary)
        else:
            part = self._allocator.allocate(wrench - held)
        force, subset = self._held.copy(), np.sign(self._held).astype(np.int8)
        force[self._obedient], subset[self._obedient] = part.force, part.subset
        return replace(part, force=force, wrench=part.wrench + held, subset=subset)

    def motor_force(self, force: Vector) -> Vector:
        """Forces (m,) to ask of the motors as if they were whole, so that weak ones give `force`; 0 of the others."""
        asked = np.zeros_like(force)
        asked[self._obedient] = force[self._obedient] / self.health.efficiency[self._obedient]
        return asked
