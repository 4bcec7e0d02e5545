"""Rolling level about an axis that points somewhere."""

from __future__ import annotations

from math import atan2

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, dot, length, times

UP = np.array([0.0, 0.0, 1.0])
STEEP = 0.1
"""Sine of the angle from the axis to the vertical below which the spin that keeps a level side level is faded out."""


@compiled
def levelling_spin(axis, axis_rate, side, time):
    """The spin about an axis [rad/s], beyond carrying its side along without spin, that brings the side to the level.

    Level means nothing where the axis is vertical, so the spin is w spin_level + (h^2 / time) phi. phi is the angle to
    level, h the sine of the angle between the axis and the vertical. spin_level is the rate that keeps a level side
    level; it grows as 1 / h. The weight w is 1 away from the vertical and 0 on it.

    Args:
        axis: unit vector, world axes; a 3-tuple or (3,), like the next two.
        axis_rate: its derivative [1/s].
        side: unit vector square to it, which is to be level and to the left.
        time: [s] in which 63 % of phi go where the axis is level.
    """
    level = cross_tuples((0.0, 0.0, 1.0), axis)
    h = length(level)
    if not h > 1e-9:
        return 0.0
    level = times(1.0 / h, level)
    phi = atan2(dot(cross_tuples(axis, side), level), dot(side, level))
    fade = min(1.0, h / STEEP) ** 3
    spin_level = dot(cross_tuples(axis, level), cross_tuples((0.0, 0.0, 1.0), axis_rate)) / h
    return fade * spin_level + h**2 / time * phi
