"""Any allocator over the motors that obey, rebuilt whenever the belief about them changes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation, Status
from cube_sim.allocation.allocator import Allocator, electrical_power
from cube_sim.allocation.methods import WrenchAllocator
from cube_sim.allocation.previous import Standing
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import bounded, numbers, pairs
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.health import Health
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import effective_matrix, error_size, lever_arm
from cube_sim.wrench.tolerances import FORCE_ROUNDING

Build = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int_]], WrenchAllocator]
"""(A (n, k), limits (k, 4) [N], which motors (k,), from 0) -> an allocator for k motors."""

LEAST_EFFICIENCY = 1e-6
"""A motor with less of its force counts as dead: what it was told would be a millionfold of what it makes."""


class FaultTolerant:
    """One vehicle's allocation through the loss of motors.

    A dead motor's column is dropped; a weak one keeps its column with its limits scaled; a stuck one's wrench is taken
    off every demand. Motors that together make no wrench at all rest. The allocator built for the others goes on from
    where they stand: what a reversal is, and what a change is counted from, outlives the event.

    Args:
        A: (n, m) actuation matrix, see `Allocator`.
        limits: (m, 4) of whole motors [N], see `Allocator`.
        build: makes the allocator for the motors that obey.
        power_coefficients: (m, 2) or (2,) see `Allocator`; with them every answer says the power of all motors, stuck
            ones included. Without, it says what the built allocator does, as long as no other motor draws power.

    Attributes:
        A: (n, m).
        limits: (m, 4) of whole motors [N].
        health: what is believed.

    Raises:
        AllocationError: an argument has the wrong shape or means nothing.
    """

    def __init__(
        self, A: ArrayLike, limits: ArrayLike, build: Build, power_coefficients: ArrayLike | None = None
    ) -> None:
        self.A = effective_matrix(A)
        m = self.A.shape[1]
        self.limits, self._build = thruster_limits(limits, m), build
        self._power = None if power_coefficients is None else pairs("power_coefficients", power_coefficients, m)
        self._rounding_N = FORCE_ROUNDING * float(np.max(np.abs(self.limits)))
        self._standing = Standing.at_rest(m)
        self.health = Health.whole(m)
        self.believe(self.health)

    def believe(self, health: Health) -> None:
        """Allocate from now on for motors in this state, whatever was believed before.

        Raises:
            AllocationError: it speaks of another number of motors, or of an efficiency outside 0 to 1.
        """
        m = self.A.shape[1]
        health = Health(numbers("efficiency", health.efficiency, "row"), numbers("stuck", health.stuck, "row"))
        for name, values in zip(health._fields, health, strict=True):
            if values.shape != (m,):
                raise AllocationError(f"{name} has shape {values.shape}; the vehicle has {m} motors")
        if not np.all((health.efficiency >= 0.0) & (health.efficiency <= 1.0)):
            raise AllocationError(f"efficiency is {health.efficiency.tolist()}; every entry must lie in 0 to 1")
        if np.any(np.isinf(health.stuck)):
            raise AllocationError(f"stuck is {health.stuck.tolist()}; a motor holds a finite force, or obeys (NaN)")
        bounded("stuck", np.nan_to_num(health.stuck))
        weakest = health.efficiency < LEAST_EFFICIENCY
        health = health._replace(efficiency=np.where(weakest, 0.0, health.efficiency))
        standing, obedient = stand(self._standing, self.health, health), np.flatnonzero(health.obedient)
        allocator = None
        if not (self.A[:, obedient].any() and self.limits[obedient].any()):
            obedient = obedient[:0]
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

    def allocate(self, wrench: ArrayLike, secondary: ArrayLike | None = None) -> Allocation:
        """Forces (m,) of all motors for a demand (n,): dead ones 0, stuck ones what they hold.

        Args:
            wrench: all that is demanded [N, N m]; one that is not finite counts as zero.
            secondary: the part (n,) of it that gives way to the rest, to an allocator that knows parts; None for none.

        Returns:
            An answer whose forces are what motors make, weak ones included; its cost counts those that obey.

        Raises:
            AllocationError: the wrench or its part is not n numbers.
        """
        demand, yielding = self._checked("the wrench", wrench), None
        valid = bool(np.isfinite(demand).all())
        if secondary is not None:
            yielding = self._checked("the secondary part", secondary)
            valid = valid and bool(np.isfinite(yielding).all())
        held = self.A @ self._held
        left = (demand if valid else np.zeros_like(demand)) - held
        if self._allocator is None:
            part = self._forceless(left, 0)
        elif valid and yielding is not None and yielding.any() and isinstance(self._allocator, Allocator):
            with np.errstate(over="ignore"):
                primary = left - yielding
            part = self._allocator.allocate_by_priority(primary, yielding)
        else:
            part = self._allocator.allocate(left)
        force, subset = self._held.copy(), np.sign(self._held).astype(np.int8)
        force[self._obedient], subset[self._obedient] = part.force, part.subset
        self._standing = self._standing.then(force, subset)
        power = None if self._held.any() else part.power_W
        return part._replace(
            force=force,
            wrench=part.wrench + held,
            subset=subset,
            status=part.status if valid else Status.INVALID_WRENCH,
            power_W=power if self._power is None else electrical_power(self._power, force),
        )

    def without_force(self, wrench: ArrayLike) -> Allocation:
        """The answer of m motors that make no force whatever they are told: without voltage. It is not remembered.

        Args:
            wrench: (n,) as for `allocate`.
        """
        demand = self._checked("the wrench", wrench)
        if np.isfinite(demand).all():
            return self._forceless(demand, self.count)
        return self._forceless(np.zeros_like(demand), self.count)._replace(status=Status.INVALID_WRENCH)

    def _forceless(self, demand: NDArray[np.float64], motors: int) -> Allocation:
        """The answer of so many motors without force to a finite demand (n,), which is met when it is a rounding."""
        residual = error_size(demand, lever_arm(self.A, axes_of(len(self.A))))
        return Allocation(
            force=np.zeros(motors),
            wrench=np.zeros_like(demand),
            wrench_error=demand.copy(),
            residual=residual,
            cost=0.0,
            subset=np.zeros(motors, np.int8),
            status=Status.EXACT if residual <= self._rounding_N else Status.CLOSEST,
            power_W=None if self._power is None else 0.0,
        )

    def _checked(self, name: str, wrench: ArrayLike) -> NDArray[np.float64]:
        """A wrench (n,)."""
        checked = numbers(name, wrench, "vector")
        if checked.shape != (len(self.A),):
            raise AllocationError(f"{name} has shape {checked.shape}; A has {len(self.A)} rows")
        return checked

    def motor_force(self, force: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces (m,) to ask of the motors as if they were whole, so that weak ones make `force`; 0 of the others.

        What is a rounding off a whole motor's interval is moved to its end.
        """
        asked, low, edge_low, edge_high, high = np.zeros_like(force), *self.limits.T
        asked[self._obedient] = force[self._obedient] / self.health.efficiency[self._obedient]
        inside = np.where(asked < 0.0, np.clip(asked, low, edge_low), np.clip(asked, edge_high, high))
        return np.where((asked != 0.0) & (np.abs(inside - asked) <= self._rounding_N), inside, asked)


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
