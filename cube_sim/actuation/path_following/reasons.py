"""The verdict's reasons in words: what is left, which course, which share of its wrench."""

from __future__ import annotations

import math

import numpy as np

from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.wrench.axes import Vector

_LEAST = 0.01


def components_left(actuation: Subspaces) -> str:
    """How many components of the wrench the thrusters that are left produce."""
    n = len(actuation.matrix)
    if actuation.rank == n:
        return f"all {n} components are produced"
    forces, torques = actuation.pure_forces.shape[1], actuation.pure_torques.shape[1]
    return f"{actuation.rank} of {n} components are left: {forces} pure force, {torques} pure torque"


def course(inclination_rad: float) -> str:
    """A course by its angle above the horizontal."""
    degrees = np.degrees(inclination_rad)
    if abs(degrees) < 0.5:
        return "a level course"
    return f"a course {'climbing' if degrees > 0.0 else 'sinking'} at {abs(degrees):.0f} deg"


def along(direction: Vector) -> str:
    """A unit vector (3,) in body axes."""
    x, y, z = np.round(direction, 2) + 0.0
    return f"the body's ({x:g}, {y:g}, {z:g})"


def percent(share: float) -> str:
    """A share in percent, rounded down: one short of all never reads 100 %.

    From 10 % on it has whole numbers, below two digits.

    Args:
        share: finite, not negative.
    """
    value = 100.0 * share
    if 0.0 < value < _LEAST:
        return f"less than {_LEAST:g} %"
    decimals = 0 if value >= 10.0 or value == 0.0 else 1 if value >= 1.0 else 2
    return f"{math.floor(value * 10**decimals) / 10**decimals:.{decimals}f} %"
