"""Any allocator over the thrusters that respond, rebuilt whenever more is known about their health."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.allocation import Allocation, Status
from cube_sim.allocation.flown import FlownAllocator
from cube_sim.allocation.previous import PreviousForces
from cube_sim.allocation.protocol import WrenchAllocator
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import bounded, numbers
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.health import Health
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import effective_matrix, error_size, lever_arm
from cube_sim.wrench.tolerances import FORCE_ROUNDING

if TYPE_CHECKING:
    from cube_sim.allocation.responsive import ResponsiveThrusters

Build = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int_]], WrenchAllocator]
"""(A (n, k), limits (k, 4) [N], which thrusters (k,), from 0) -> an allocator for k thrusters."""

LEAST_EFFICIENCY = 1e-6
"""Share of its force below which a thruster counts as dead: it would be told a million times what it makes."""


class AllocationMemory(NamedTuple):
    """What an allocation goes on from.

    Attributes:
        health: of the thrusters.
        previous: forces of the answer before.
        inner: what the allocator for the responsive thrusters remembers beside it; None for nothing.
    """

    health: Health
    previous: PreviousForces
    inner: Any


class FaultTolerant:
    """One vehicle's allocation through the loss of thrusters.

    The column of a dead thruster is dropped. A weak one keeps its column with its limits scaled. The wrench of a stuck
    one is taken off every demand. Thrusters that together make no wrench at all rest. The allocator built for the
    others goes on from their previous forces: what a reversal is, and what a change is counted from, outlives the
    event.

    Args:
        A: (n, m) actuation matrix, see `Allocator`.
        limits: (m, 4) of whole thrusters [N], see `Allocator`.
        build: makes the allocator for the thrusters that respond.

    Attributes:
        A: (n, m).
        limits: (m, 4) of whole thrusters [N].
        health: of the thrusters, as last set.
        told: what `set_health` was given last, the same object.

    Raises:
        AllocationError: an argument has the wrong shape or means nothing.
    """

    def __init__(self, A: ArrayLike, limits: ArrayLike, build: Build) -> None:
        self.A = effective_matrix(A)
        m = self.A.shape[1]
        self.limits, self._build = thruster_limits(limits, m), build
        self._limits = self.limits.copy()
        self._rounding_N = FORCE_ROUNDING * float(np.max(np.abs(self.limits)))
        self._previous = PreviousForces.at_rest(m)
        self.health, self._allocator = Health.whole(m), None
        self.set_health(self.health)

    def set_health(self, health: Health) -> None:
        """Allocate from now on for thrusters in this state, whatever it was before.

        Args:
            health: of all m thrusters.

        Raises:
            AllocationError: it speaks of another number of thrusters, or of an efficiency outside 0 to 1.
        """
        m = self.A.shape[1]
        self.told = health
        health = Health(numbers("efficiency", health.efficiency, "row"), numbers("stuck", health.stuck, "row"))
        for name, values in zip(health._fields, health, strict=True):
            if values.shape != (m,):
                raise AllocationError(f"{name} has shape {values.shape}; the vehicle has {m} thrusters")
        if not np.all((health.efficiency >= 0.0) & (health.efficiency <= 1.0)):
            raise AllocationError(f"efficiency is {health.efficiency.tolist()}; every entry must lie in 0 to 1")
        if np.any(np.isinf(health.stuck)):
            raise AllocationError(
                f"stuck is {health.stuck.tolist()}; a thruster holds a finite force, or responds (NaN)"
            )
        bounded("stuck", np.nan_to_num(health.stuck))
        weakest = health.efficiency < LEAST_EFFICIENCY
        health = health._replace(efficiency=np.where(weakest, 0.0, health.efficiency))
        previous, responsive = carried_over(self._previous, self.health, health), np.flatnonzero(health.responsive)
        allocator = None
        if not (self.A[:, responsive].any() and self.limits[responsive].any()):
            responsive = responsive[:0]
        if responsive.size:
            limits = self.limits[responsive] * health.efficiency[responsive, None]
            allocator = self._build(self.A[:, responsive], limits, responsive)
            allocator.resume(previous.of(responsive))
        self.settle()  # whoever allocated until now
        self.health, self._previous, self._responsive, self._allocator = health, previous, responsive, allocator
        self._held = np.where(np.isnan(health.stuck), 0.0, health.stuck)
        self._held_wrench = self.A @ self._held
        self._all_respond = responsive.size == m
        self._responds = np.zeros(m, dtype=np.bool_)
        self._responds[responsive] = True

    def limit(self, limits: NDArray[np.float64], margin: float) -> None:
        """Allocate from now on within limits of the moment, going on from the previous answer.

        Args:
            limits: (m, 4) of whole thrusters [N].
            margin: share by which their dead zones are taken to be wider.
        """
        from cube_sim.allocation.responsive import limits_of_some, widen_dead_zones  # only here: it loads the compiler

        widen_dead_zones(limits, margin, self._limits)
        if self._allocator is None:
            return
        some = limits_of_some(self._limits, self._responsive, self.health.efficiency)
        follow = getattr(self._allocator, "limit", None)
        if follow is None or not follow(some):
            self.settle()
            self._allocator = self._build(self.A[:, self._responsive], some, self._responsive)
            self._allocator.resume(self._previous.of(self._responsive))

    @property
    def limits_now(self) -> NDArray[np.float64]:
        """(m, 4) of whole thrusters [N], as `limit` said last, where it has."""
        return self._limits

    @property
    def follows_limits(self) -> bool:
        """Whether the allocator takes other limits as it stands, in compiled code too."""
        return hasattr(self._allocator, "limit")

    def reset(self) -> None:
        """Forget the previous answer, not the faults."""
        self._previous = PreviousForces.at_rest(self.count)
        if self._allocator is not None:
            self._allocator.reset()

    def settle(self) -> None:
        """See to it that every answer so far is confirmed, where the method says so."""
        settle = getattr(self._allocator, "settle", None)
        if settle is not None:
            settle()

    def ask_again(self) -> None:
        """Ask one of the user's own once more that had no answer in compiled code, for the error that says why."""
        again = getattr(self._allocator, "ask_again", None)
        if again is not None:
            again()

    def memory(self) -> AllocationMemory:
        """What `recall` needs to go on from here."""
        remember = getattr(self._allocator, "memory", None)
        return AllocationMemory(self.health, self._previous, None if remember is None else remember())

    def recall(self, memory: AllocationMemory) -> None:
        """Go on from a memory of this allocation, or of one for the same thrusters."""
        if not memory.health.equals(self.health):
            self.set_health(memory.health)
        self._previous = memory.previous
        if self._allocator is None:
            return
        recall = getattr(self._allocator, "recall", None)
        if recall is not None:
            recall(memory.inner)
            return
        self._allocator.reset()
        self._allocator.resume(memory.previous.of(self._responsive))

    def made_by(self, force: ArrayLike) -> Allocation:
        """The answer when thrusters are asked for forces from outside; it is remembered.

        Args:
            force: (m,) that they would make if they were whole [N].
        """
        asked = self._checked_forces(force)
        made = np.where(self.health.responsive, asked * self.health.efficiency, self._held)
        subset = np.sign(made).astype(np.int8)
        self._previous = self._previous.followed_by(made, subset)
        if self._allocator is not None:
            self._allocator.resume(self._previous.of(self._responsive))
        wrench = self.A @ made
        cost = float(made[self._responsive] @ made[self._responsive])
        return Allocation(made, wrench, np.zeros_like(wrench), 0.0, cost, subset, Status.EXACT)

    def _checked_forces(self, force: ArrayLike) -> NDArray[np.float64]:
        """Forces (m,)."""
        checked = numbers("the forces", force, "vector")
        if checked.shape != (self.count,):
            raise AllocationError(f"the forces have shape {checked.shape}; the vehicle has {self.count} thrusters")
        return checked

    @property
    def count(self) -> int:
        """m, dead and stuck ones included."""
        return self.A.shape[1]

    def allocate(self, wrench: ArrayLike, secondary: ArrayLike | None = None) -> Allocation:
        """Forces (m,) of all thrusters for a demand (n,): dead ones 0, stuck ones what they hold.

        Args:
            wrench: all that is demanded [N, N m]; one that is not finite counts as zero.
            secondary: the part (n,) of it that gives way to the rest, see `WrenchAllocator`; None for none.

        Returns:
            An answer whose forces are what thrusters make, weak ones included; its cost counts those that respond.

        Raises:
            AllocationError: the wrench or its part is not n numbers.
        """
        demand, yielding = self._checked("the wrench", wrench), None
        valid = bool(np.isfinite(demand).all())
        if secondary is not None:
            yielding = self._checked("the secondary part", secondary)
            valid = valid and bool(np.isfinite(yielding).all())
        left = (demand if valid else np.zeros_like(demand)) - self._held_wrench
        if self._allocator is None:
            part = self._forceless(left, 0)
        elif valid and yielding is not None and yielding.any():
            with np.errstate(over="ignore"):
                primary = left - yielding
            part = self._allocator.allocate_by_priority(primary, yielding)
        else:
            part = self._allocator.allocate(left)
        if self._all_respond:
            self._previous = self._previous.followed_by(part.force, part.subset)
            return part if valid else part._replace(status=Status.INVALID_WRENCH)
        force, subset = self._held.copy(), np.sign(self._held).astype(np.int8)
        force[self._responsive], subset[self._responsive] = part.force, part.subset
        self._previous = self._previous.followed_by(force, subset)
        return part._replace(
            force=force,
            wrench=part.wrench + self._held_wrench,
            subset=subset,
            status=part.status if valid else Status.INVALID_WRENCH,
        )

    def without_force(self, wrench: ArrayLike) -> Allocation:
        """The answer of m thrusters that make no force whatever they are told: without voltage. It is not remembered.

        Args:
            wrench: (n,) as for `allocate`.
        """
        demand = self._checked("the wrench", wrench)
        if np.isfinite(demand).all():
            return self._forceless(demand, self.count)
        return self._forceless(np.zeros_like(demand), self.count)._replace(status=Status.INVALID_WRENCH)

    def _forceless(self, demand: NDArray[np.float64], thrusters: int) -> Allocation:
        """The answer of so many thrusters without force to a finite demand (n,), which is met when it is a rounding."""
        residual = error_size(demand, lever_arm(self.A, axes_of(len(self.A))))
        return Allocation(
            force=np.zeros(thrusters),
            wrench=np.zeros_like(demand),
            wrench_error=demand.copy(),
            residual=residual,
            cost=0.0,
            subset=np.zeros(thrusters, np.int8),
            status=Status.EXACT if residual <= self._rounding_N else Status.CLOSEST,
        )

    def flown(self, two_parts: bool) -> tuple[FlownAllocator, ResponsiveThrusters] | None:
        """Who allocates for the thrusters that respond, and what the compiled allocation needs to go on from here.

        `take_over` tells this object of what it did.

        Args:
            two_parts: whether demands have a part that gives way.

        Returns:
            None where only Python asks the allocator of the thrusters that respond.
        """
        # Only here: it loads the compiler.
        from cube_sim.allocation.responsive import ResponsiveThrusters

        flown: Callable[[bool], FlownAllocator | None] | None = getattr(self._allocator, "flown", None)
        if flown is None or (inner := flown(two_parts)) is None:
            return None
        return inner, ResponsiveThrusters(
            inner.packed,
            self._responsive,
            self._held,
            self._held_wrench,
            self.health.efficiency,
            self._responds,
            self._limits,
            self._rounding_N,
            *(np.array(values, dtype=np.float64) for values in self._previous),
        )

    def take_over(self, thrusters: ResponsiveThrusters) -> None:
        """Go on from where the compiled allocation has come with what `flown` gave."""
        self._previous = PreviousForces(thrusters.force, thrusters.subset, thrusters.push)

    def _checked(self, name: str, wrench: ArrayLike) -> NDArray[np.float64]:
        """A wrench (n,)."""
        checked = numbers(name, wrench, "vector")
        if checked.shape != (len(self.A),):
            raise AllocationError(f"{name} has shape {checked.shape}; A has {len(self.A)} rows")
        return checked

    def force_if_whole(self, force: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces to ask of the thrusters as if they were whole, so that weak ones make what is wanted of them.

        What is a rounding off a whole thruster's interval is moved to its end.

        Args:
            force: (m,) wanted [N].

        Returns:
            (m,) [N], 0 of those that do not respond.
        """
        from cube_sim.allocation.asked_forces import asked_forces  # only here: it loads the compiler

        return asked_forces(force, self.health.efficiency, self._responds, self._limits, self._rounding_N)


def carried_over(previous: PreviousForces, before: Health, now: Health) -> PreviousForces:
    """The forces thrusters make when their health changes while what they are told does not.

    A thruster that grows weaker makes less of what it is told, on the same side. One that was stuck starts from the
    force it held, one that was dead from rest.

    Args:
        previous: of the m thrusters, in the health before.
        before: their health then.
        now: their health from now on.
    """
    share = np.divide(now.efficiency, before.efficiency, out=np.zeros_like(now.efficiency), where=before.responsive)
    kept = now.responsive & before.responsive
    force = np.where(kept, previous.force * share, 0.0)
    force = np.where(now.responsive & ~np.isnan(before.stuck), before.stuck, force)
    force = np.where(np.isnan(now.stuck), force, now.stuck)
    return previous.followed_by(force, np.where(kept, previous.subset, np.sign(force)))
