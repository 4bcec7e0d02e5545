"""Rolling level about an axis that points somewhere."""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Vector, cross

UP = np.array([0.0, 0.0, 1.0])
STEEP = 0.1
"""Sine of the angle from the axis to the vertical below which the spin that keeps a level side level is faded out."""


def levelling_spin(axis: Vector, axis_rate: Vector, side: Vector, time: float) -> float:
    """The spin about an axis [rad/s], beyond carrying its side along without spin, that brings the side to the level.

    Level means nothing where the axis is vertical, so the spin is w spin_level + (h^2 / time) phi. phi is the angle to
    level, h the sine of the angle between the axis and the vertical. spin_level is the rate that keeps a level side
    level; it grows as 1 / h. The weight w is 1 away from the vertical and 0 on it.

    Args:
        axis: unit vector (3,), world axes.
        axis_rate: its derivative (3,) [1/s].
        side: unit vector square to it (3,), which is to be level and to the left.
        time: [s] in which 63 % of phi go where the axis is level.
    """
    level = cross(UP, axis)
    h = float(np.linalg.norm(level))
    if not h > 1e-9:
        return 0.0
    level /= h
    phi = float(np.arctan2(cross(axis, side) @ level, side @ level))
    fade = min(1.0, h / STEEP) ** 3
    spin_level = float(cross(axis, level) @ cross(UP, axis_rate)) / h
    return fade * spin_level + h**2 / time * phi
