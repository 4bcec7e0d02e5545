"""Any allocator over the motors that obey, rebuilt whenever the belief about them changes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocator import Allocator
from cube_sim.allocation.factory import WrenchAllocator
from cube_sim.allocation.geometry import actuation_matrix, lever_length, torque_rows
from cube_sim.allocation.health import Health
from cube_sim.allocation.limits import thruster_limits
from cube_sim.allocation.result import Allocation, Status
from cube_sim.allocation.standing import Standing
from cube_sim.errors import AllocationError

Build = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int_]], WrenchAllocator]
"""(A (n, k), limits (k, 4) [N], which motors (k,), from 0) -> an allocator for k motors."""


class FaultTolerant:
    """One vehicle's allocation through the loss of motors.

    A dead motor's column is dropped; a weak one keeps its column with its limits scaled; a stuck one's wrench is taken
    off every demand. The allocator built for the rest goes on from where the motors stand: what a reversal is, and
    what a change is counted from, outlives the event.

    Args:
        A: (n, m) actuation matrix, see `Allocator`.
        limits: (m, 4) of whole motors [N], see `Allocator`.
        build: makes the allocator for the motors that obey.

    Attributes:
        A: (n, m).
        limits: (m, 4) of whole motors [N].
        health: what is believed.

    Raises:
        AllocationError: an argument has the wrong shape or means nothing.
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, build: Build) -> None:
        self.A = actuation_matrix(A)
        m = self.A.shape[1]
        self.limits, self._build = thruster_limits(limits, m), build
        self._standing = Standing.at_rest(m)
        self.health = Health.whole(m)
        self.believe(self.health)

    def believe(self, health: Health) -> None:
        """Allocate from now on for motors in this state, whatever was believed before.

        Raises:
            AllocationError: it speaks of another number of motors, or of an efficiency outside 0 to 1.
        """
        m = self.A.shape[1]
        for name, values in (("efficiency", health.efficiency), ("stuck", health.stuck)):
            if np.shape(values) != (m,):
                raise AllocationError(f"{name} has shape {np.shape(values)}; the vehicle has {m} motors")
        if not np.all((health.efficiency >= 0.0) & (health.efficiency <= 1.0)):
            raise AllocationError(f"efficiency is {health.efficiency.tolist()}; every entry must lie in 0 to 1")
        if np.any(np.isinf(health.stuck)):
            raise AllocationError(f"stuck is {health.stuck.tolist()}; a motor holds a finite force, or obeys (NaN)")
        standing, obedient = stand(self._standing, self.health, health), np.flatnonzero(health.obedient)
        allocator = None
        if obedient.size:
            limits = self.limits[obedient] * health.efficiency[obedient, None]
            allocator = self._build(self.A[:, obedient], limits, obedient)
            allocator.resume(standing.of(obedient))
        self.health, self._standing, self._obedient, self._allocator = health, standing, obedient, allocator
        self._held = np.where(np.isnan(health.stuck), 0.0, health.stuck)

    def reset(self) -> None:
        """Forget the previous answer, not the faults."""
        self._standing = Standing.at_rest(self.count)
        if self._allocator is not None:
            self._allocator.reset()

    @property
    def count(self) -> int:
        """m, dead and stuck ones included."""
        return self.A.shape[1]

    @property
    def working_matrix(self) -> NDArray[np.float64]:
        """(n, k) columns of the motors that obey."""
        return self.A[:, self._obedient]

    def allocate(self, wrench: NDArray[np.float64], secondary: NDArray[np.float64] | None = None) -> Allocation:
        """Forces (m,) of all motors for a demand (n,): dead ones 0, stuck ones what they hold.

        Args:
            wrench: all that is demanded [N, N m].
            secondary: the part (n,) of it that gives way to the rest, to an allocator that knows parts; None for none.

        Returns:
            An answer whose forces are what motors make, weak ones included; its cost counts those that obey.
        """
        held = self.A @ self._held
        if self._allocator is None:
            part = self._nothing(wrench - held)
        elif secondary is not None and secondary.any() and isinstance(self._allocator, Allocator):
            part = self._allocator.allocate_by_priority(wrench - held - secondary, secondary)
        else:
            part = self._allocator.allocate(wrench - held)
        force, subset = self._held.copy(), np.sign(self._held).astype(np.int8)
        force[self._obedient], subset[self._obedient] = part.force, part.subset
        self._standing = self._standing.then(force, subset)
        return part._replace(force=force, wrench=part.wrench + held, subset=subset)

    def _nothing(self, error: NDArray[np.float64]) -> Allocation:
        """The answer of no motors, `error` (n,) short of the demand."""
        scaled = error.copy()
        scaled[torque_rows(len(error))] /= lever_length(self.A)
        residual = float(np.linalg.norm(scaled))
        return Allocation(np.empty(0), np.zeros_like(error), error, residual, 0.0, np.empty(0, np.int8), Status.CLOSEST)

    def motor_force(self, force: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces (m,) to ask of the motors as if they were whole, so that weak ones make `force`; 0 of the others."""
        asked = np.zeros_like(force)
        asked[self._obedient] = force[self._obedient] / self.health.efficiency[self._obedient]
        return asked


def stand(standing: Standing, before: Health, now: Health) -> Standing:
    """Where motors stand when their health changes while what they are told does not.

    A motor that grows weaker makes less of what it is told, on the same side. One that was stuck starts from the force
    it held, one that was dead from rest.
    """
    share = np.divide(now.efficiency, before.efficiency, out=np.zeros_like(now.efficiency), where=before.obedient)
    force = np.where(now.obedient & before.obedient, standing.force * share, 0.0)
    force = np.where(now.obedient & ~np.isnan(before.stuck), before.stuck, force)
    force = np.where(np.isnan(now.stuck), force, now.stuck)
    kept = now.obedient & before.obedient
    return standing.then(force, np.where(kept, standing.subset, np.sign(force)))
