"""The pace along the path that the thrusters can keep.

The target on the path waits for the vehicle (s' = v_T + k2 s1). So the speed along the path is free. It is the first to
fall where the thrusters cannot make all that is asked: the path is kept, at the speed that is left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.attainable.attainable_set import AttainableSet
from cube_sim.control.moment_budget import NOTHING_MOVES, RESERVE, MomentBudget
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.tuples import matrix_times_tuple, plus, plus6, stacked, times
from cube_sim.vehicle.laws.hull_motion import steady_wrench

FINEST = 16
"""Steps in which shares of the speed along the path are tried from 1 to 0, and as many to -1: back along it, with a
current too strong."""
LEAST_PACE = 0.25
"""Share of the speed below which the vehicle turns to an attitude in which the thrusters have more (a choice)."""
NO_BOUND_N = 1e-9
"""A facet that allows less than this allows nothing [N]."""
HALVINGS = 5
"""Steps of bisection between two of them."""

Facets = tuple[Matrix, Vector, Vector]
"""Normals, bounds and held shares of `ForceBudget`."""
NO_BUDGET: Facets = (np.zeros((0, 6)), np.zeros(0), np.zeros(0))
"""Where none are known."""


@dataclass(frozen=True)
class ForceBudget:
    """What the thrusters that work can make.

    Attributes:
        attainable: the wrenches of those that respond.
        held: (6,) [N, N m] of those that are stuck, on top of it.
        matrix: A (6,k) of those that respond.
        limits: (2,k) their least and largest forces [N].
        which: (k,) which of the vehicle's thrusters they are; None where nobody asks.
        share: (k,) share of its force that each gives; None likewise.
        moving: what of it follows limits that move; nothing of one that others share.
    """

    attainable: AttainableSet
    held: Vector
    matrix: Matrix
    limits: Matrix
    which: NDArray[np.int64] | None = None
    share: Vector | None = None
    moving: MomentBudget = NOTHING_MOVES

    def made_to_move(self) -> ForceBudget:
        """The same for one controller, whose limits follow inflow and voltage."""
        assert self.which is not None
        assert self.share is not None
        own = AttainableSet(self.attainable.normals, self.attainable.offsets.copy())
        limits = np.ascontiguousarray(self.limits).copy()
        budget = ForceBudget(own, self.held, self.matrix, limits, self.which, self.share)
        gains = np.ascontiguousarray(budget.normals @ self.matrix)
        return replace(budget, moving=MomentBudget(gains, self.which, self.share, own.offsets, budget.bounds, limits))

    def __getstate__(self) -> dict[str, object]:
        """What a copy takes over, taken at once: another thread may be filling in what is cached here."""
        return dict(self.__dict__)

    @cached_property
    def normals(self) -> Matrix:
        """(p,6) of the facets."""
        return np.ascontiguousarray(self.attainable.normals)

    @cached_property
    def bounds(self) -> Vector:
        """(p,) [N] with the reserve: a wrench w is within them if normals w <= bounds, for what is held and all."""
        if len(self.moving.bounds):
            return self.moving.bounds
        return (1.0 - RESERVE) * self.attainable.offsets

    @cached_property
    def held_shares(self) -> Vector:
        """(p,) [N]: normals times what is held."""
        return self.normals @ self.held


class PaceDemand(NamedTuple):
    """What a pace along the path asks for; 3- and 6-tuples in body axes.

    Attributes:
        flow: velocity through the water at full pace [m/s].
        along: the part of it along the path [m/s].
        push: the force that this part asks for beside that of a steady motion [N].
        rest: the wrench beside that of the steady motion at full pace [N, N m].
        up: world up.
    """

    flow: tuple[float, float, float]
    along: tuple[float, float, float]
    push: tuple[float, float, float]
    rest: tuple[float, float, float, float, float, float]
    up: tuple[float, float, float]


@compiled
def wrench_at_pace(hull, demand, pace):
    """The wrench, a 6-tuple, with the torque that holds the attitude.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        demand: `PaceDemand`.
        pace: share of the speed along the path.
    """
    fewer = pace - 1.0
    steady = steady_wrench(hull, plus(demand.flow, times(fewer, demand.along)), demand.up)
    return plus6(plus6(steady, demand.rest), stacked(times(fewer, demand.push), (0.0, 0.0, 0.0)))


@compiled
def in_range(left, wrench):
    """A wrench (6-tuple) moved into the range of A, see `Capability.project_onto_range`; left a record `CAPABILITY`."""
    moved, shift = matrix_times_tuple(left[0].projector, wrench), left[0].shift
    return plus6(moved, (shift[0], shift[1], shift[2], shift[3], shift[4], shift[5]))


@compiled
def facet_excess(normals, bounds, held_shares, force_ratio, i, wrench):
    """By how much a wrench (6-tuple) exceeds facet i of what is attainable with the reserve [N]."""
    needed = -held_shares[i]
    for j in range(6):
        needed += normals[i, j] * wrench[j]
    return needed - force_ratio * bounds[i]


@compiled
def is_allowed(normals, bounds, held_shares, force_ratio, wrench):
    """Whether a wrench (6-tuple) in the range of A is attainable with the reserve.

    Args:
        normals: of `ForceBudget`, like the next two.
        bounds: of it.
        held_shares: of it.
        force_ratio: share of their force that the supply leaves the thrusters.
        wrench: in the range of A.
    """
    for i in range(len(bounds)):
        excess = facet_excess(normals, bounds, held_shares, force_ratio, i, wrench)
        if not excess <= 1e-9 * (1.0 + abs(force_ratio * bounds[i])):
            return False
    return True


@compiled
def largest_share(hull, left, normals, bounds, held_shares, force_ratio, demand, least):
    """The largest share of the demand's part of the speed that is allowed, to 0.2 %; -2 where none down to `least` is.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        left: record of `cube_sim.control.authority.CAPABILITY`.
        normals: of `ForceBudget`, like the next two.
        bounds: of it.
        held_shares: of it.
        force_ratio: share of their force that the supply leaves the thrusters.
        demand: `PaceDemand`.
        least: the smallest to look at, from -1 to 1.
    """
    low, step = 1.0, 1.0 / FINEST
    while not is_allowed(normals, bounds, held_shares, force_ratio, in_range(left, wrench_at_pace(hull, demand, low))):
        low -= step
        if low < least:
            return -2.0
    if low == 1.0:
        return low
    return _between(hull, left, normals, bounds, held_shares, force_ratio, demand, low)


@compiled
def _between(hull, left, normals, bounds, held_shares, force_ratio, demand, low):
    """The largest share that is allowed between one that is and the next step, that is not, to 0.2 %."""
    high = low + 1.0 / FINEST
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        wrench = in_range(left, wrench_at_pace(hull, demand, middle))
        if is_allowed(normals, bounds, held_shares, force_ratio, wrench):
            low = middle
        else:
            high = middle
    return low


@compiled
def worst_excess(normals, bounds, held_shares, force_ratio, wrench):
    """By how much a wrench (6-tuple) exceeds what is attainable with the reserve, as a share of the facet's bound."""
    worst = -np.inf
    for i in range(len(bounds)):
        excess = facet_excess(normals, bounds, held_shares, force_ratio, i, wrench)
        worst = max(worst, excess / max(abs(force_ratio * bounds[i]), NO_BOUND_N))
    return worst


@compiled
def share_while_it_helps(hull, left, normals, bounds, held_shares, force_ratio, demand):
    """The share to which the demand's part of the speed falls where a hull points its thrust.

    It falls to what is allowed only as long as each step brings it nearer to that. Such a hull needs its way on:
    slower, the water holds less of it, and what it is short of may grow. A speed far below, or back, may be allowed,
    but is not what its attitude points. Where nothing on the way is allowed, it is the nearest, `LEAST_PACE` at least.

    Args:
        hull: as for `largest_share`, like all that follow.
        left: see there.
        normals: see there.
        bounds: see there.
        held_shares: see there.
        force_ratio: see there.
        demand: see there.
    """
    nearest, share = np.inf, 1.0
    for i in range(FINEST + 1):
        tried = 1.0 - i / FINEST
        wrench = in_range(left, wrench_at_pace(hull, demand, tried))
        excess = worst_excess(normals, bounds, held_shares, force_ratio, wrench)
        if excess >= nearest:
            break
        nearest, share = excess, tried
        if is_allowed(normals, bounds, held_shares, force_ratio, wrench):
            return share if i == 0 else _between(hull, left, normals, bounds, held_shares, force_ratio, demand, share)
    return max(share, LEAST_PACE)
