"""How high a hull is asked to rise: what is out of the water carries nothing, and the thrusters have to lift it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector

HELD = 0.5
"""Share of what the thrusters lift that holds a hull out of the water: the rest is for all else (a choice)."""
SINKING_M_S = 0.2
"""A hull that is above is asked to go down no faster (a choice)."""
_LEAST_UP = 1e-6  # of a facet's normal, below which it does not bound what goes straight up
NO_CEILING = np.zeros((3, 0))
"""The table of endless water."""


@dataclass(frozen=True)
class Ceiling:
    """What a hull at the surface lacks, upright and at rest.

    Attributes:
        heights: (n,) of its origin [m], world axes, increasing, the first one just awash.
        missing: (n,) its weight less what the water carries of it there [N].
        wet: (n,) share of their vertical force that the thrusters still make there.
    """

    heights: Vector
    missing: Vector
    wet: Vector

    def highest(self, up: float) -> float:
        """The height that thrusters hold which lift so much under water [N], see `highest_held`."""
        return highest_held(self.table, up)

    @cached_property
    def table(self) -> Matrix:
        """(3,n) heights, what is missing, and the share that the thrusters make, as compiled laws read them."""
        return np.ascontiguousarray(np.stack([self.heights, self.missing, self.wet]))

    def at(self, height: float) -> tuple[float, float]:
        """What is missing at a height [N], and the share that the thrusters still make."""
        missing, wet = (float(np.interp(height, self.heights, each)) for each in (self.missing, self.wet))
        return missing, wet


@compiled
def lift(normals, bounds, held_shares, force_ratio):
    """The force straight up of an upright hull [N] that thrusters make, what is stuck included, and nothing beside it.

    Args:
        normals: (p,6) of the facets of what they make.
        bounds: (p,) of them [N].
        held_shares: (p,) normals times the wrench of what is stuck [N].
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    least, facing = inf, False
    for i in range(len(bounds)):
        if normals[i, 2] > _LEAST_UP:
            facing = True
            least = min(least, (force_ratio * bounds[i] + held_shares[i]) / normals[i, 2])
    return max(0.0, least) if facing else 0.0


@compiled
def highest_held(table, up):
    """The height [m] that thrusters hold which lift so much under water; inf where they do not even there.

    A hull that sinks whatever they do is not held by a surface.

    Args:
        table: (3,n) of `Ceiling.table`.
        up: [N].
    """
    before = HELD * up * table[2, 0] - table[1, 0]
    if not before >= 0.0:
        return inf
    for k in range(1, table.shape[1]):
        spare = HELD * up * table[2, k] - table[1, k]
        if not spare >= 0.0:
            share = before / (before - spare)
            return table[0, k - 1] + share * (table[0, k] - table[0, k - 1])
        before = spare
    return table[0, table.shape[1] - 1]


@compiled
def keep_under_surface(table, normals, bounds, held_shares, force_ratio, view, velocity, acceleration, time):
    """Let a hull rise no higher than its thrusters hold it at the voltage of the moment, see `keep_below`.

    Args:
        table: (3,n) of `Ceiling.table`; (3,0) in endless water.
        normals: of `lift`, like the next three.
        bounds: of it.
        held_shares: of it.
        force_ratio: of it.
        view: of `keep_below`, like the next three.
        velocity: of it.
        acceleration: of it.
        time: of it.
    """
    if table.shape[1] > 0:
        highest = highest_held(table, lift(normals, bounds, held_shares, force_ratio))
        if highest < inf:
            keep_below(view, velocity, acceleration, highest, time)


@compiled
def keep_below(view, velocity, acceleration, highest, time):
    """Let a hull rise no faster than it comes to rest at a height, and go down where it is above.

    Without that the force that is missing at the surface would be asked for, more of it the longer it is missing, and
    be taken from all that the thrusters could do beside it.

    Args:
        view: record of `cube_sim.guidance.view_record.VIEW`, of the hull's origin.
        velocity: desired (3,) [m/s], world axes, changed.
        acceleration: its derivative (3,) [m/s^2], world axes, changed.
        highest: height of the origin [m], world axes.
        time: in which it comes to rest there [s].
    """
    w = view[0]
    height, rising = w.row[2], 0.0
    for i in range(3):
        height += w.frame[2, i] * w.error[i]
        rising += w.frame[2, i] * w.velocity[i]
    most, slower = (highest - height) / time, -rising / time
    if most < -SINKING_M_S:
        most, slower = -SINKING_M_S, 0.0
    if velocity[2] > most:
        velocity[2], acceleration[2] = most, slower
