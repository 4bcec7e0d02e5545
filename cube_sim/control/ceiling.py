"""How high a hull is asked to rise: what is out of the water carries nothing, and the thrusters have to lift it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector

HELD = 0.5
"""Share of what the thrusters lift that holds a hull out of the water: the rest is for all else (a choice)."""
SINKING_M_S = 0.2
"""A hull that is above is asked to go down no faster (a choice)."""
_LEAST_UP = 1e-6  # of a facet's normal, below which it does not bound what goes straight up


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
        """The height that thrusters hold which lift so much under water [N]; inf where they do not even there.

        A hull that sinks whatever they do is not held by a surface.
        """
        spare = HELD * up * self.wet - self.missing
        held = spare >= 0.0
        if not held[0]:
            return inf
        if held.all():
            return float(self.heights[-1])
        k = int(np.argmin(held))
        share = spare[k - 1] / (spare[k - 1] - spare[k])
        return float(self.heights[k - 1] + share * (self.heights[k] - self.heights[k - 1]))

    def at(self, height: float) -> tuple[float, float]:
        """What is missing at a height [N], and the share that the thrusters still make."""
        missing, wet = (float(np.interp(height, self.heights, each)) for each in (self.missing, self.wet))
        return missing, wet


def most_up(normals: Matrix, bounds: Vector) -> float:
    """The force straight up of an upright hull [N] that thrusters make, and nothing beside it.

    Args:
        normals: (p,6) of the facets of what they make.
        bounds: (p,) of them [N].
    """
    facing = normals[:, 2] > _LEAST_UP
    return max(0.0, float((bounds[facing] / normals[facing, 2]).min())) if facing.any() else 0.0


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
