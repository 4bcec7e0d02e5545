"""Where the water ends, and how a hull lies in it there."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.vehicle import Vehicle

LEAST_LIFT = 1e-6
"""A hull floats that weighs less than the water it displaces by this share at least (rounding, a choice)."""


def water_surface(model: mujoco.MjModel) -> float:
    """Height of the water's surface [m], world axes; inf for endless water.

    Raises:
        ModelError: the model has no water.
    """
    return float(packing.packed_parameters(model)[layout.SURFACE])


def floating_height(model: mujoco.MjModel, vehicle: Vehicle, lighter: float = 0.0) -> float:
    """Height of the origin of an upright hull over the surface it floats at [m]; just awash for one that sinks.

    Args:
        model: the vehicle's, with a surface or without.
        vehicle: the hull.
        lighter: weight that it has let go [N].
    """
    packed = packing.packed_parameters(model)
    start, count = int(packed[layout.HULLS]), int(packed[layout.COUNT])
    records = packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE)
    record = next(each for each in records if each[layout.BODY] == vehicle.body)
    half, centre = float(record[layout.HALF_AXES + 2]), float(vehicle.centre_of_buoyancy[2])
    if not weighs_less(vehicle, lighter):
        return -half - centre
    weight, lift = _weight(vehicle) - lighter, _lift(vehicle)
    # (1 + t)^2 (2 - t) / 4 = weight / lift: its root between -1 and 1 is where Viete's formula has it
    share = max(weight / lift, 0.0)
    t = 2.0 * np.cos((np.arccos(np.clip(1.0 - 2.0 * share, -1.0, 1.0)) + 4.0 * np.pi) / 3.0)
    return -float(t) * half - centre


def weighs_less(vehicle: Vehicle, lighter: float = 0.0) -> bool:
    """Whether a hull weighs less than the water it displaces, once it has let so much weight [N] go."""
    return _weight(vehicle) - lighter < (1.0 - LEAST_LIFT) * _lift(vehicle)


def _weight(vehicle: Vehicle) -> float:
    return vehicle.mass * float(np.linalg.norm(vehicle.gravity))


def _lift(vehicle: Vehicle) -> float:
    return vehicle.displaced_mass * float(np.linalg.norm(vehicle.gravity))
