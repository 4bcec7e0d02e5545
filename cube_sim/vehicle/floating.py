"""Where the water ends, and how a hull lies in it there."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.spatial import Vector
from cube_sim.vehicle.carried_water import link_records, pose_on
from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.vehicle import Vehicle

LEAST_LIFT = 1e-6
"""A hull floats that weighs less than the water it displaces by this share at least (rounding, a choice)."""

LEAST_EXTENT_M = 1e-9
"""Half height of what has no extent (rounding, a choice) [m]."""
_HEIGHT_M = 1e-9  # to which the height of a hull with links is found


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
    extents, centres, lifts = _ellipsoids(model, vehicle)
    awash = -float((centres + extents).max())
    if not weighs_less(vehicle, lighter):
        return awash
    weight, lift = _weight(vehicle) - lighter, _lift(vehicle)
    if len(lifts) > 1:
        return _balanced(extents, centres, lifts / lifts.sum(), max(weight / lift, 0.0), awash)
    # (1 + t)^2 (2 - t) / 4 = weight / lift: its root between -1 and 1 is where Viete's formula has it
    share = max(weight / lift, 0.0)
    t = 2.0 * np.cos((np.arccos(np.clip(1.0 - 2.0 * share, -1.0, 1.0)) + 4.0 * np.pi) / 3.0)
    return -float(t) * float(extents[0]) - float(centres[0])


def _ellipsoids(model: mujoco.MjModel, vehicle: Vehicle) -> tuple[Vector, Vector, Vector]:
    """Half heights [m], heights of the centres over the origin [m] and displaced masses [kg] of hull and links, (n,).

    The hull is upright, its arm as at the reference pose.
    """
    packed = packing.packed_parameters(model)
    start, count = int(packed[layout.HULLS]), int(packed[layout.COUNT])
    records = packed[start : start + count * layout.HULL_SIZE].reshape(count, layout.HULL_SIZE)
    hull = next(each for each in records if each[layout.BODY] == vehicle.body)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    found = [(float(hull[layout.HALF_AXES + 2]), float(hull[layout.CENTRE + 2]), float(hull[layout.DISPLACED_MASS]))]
    for link in link_records(model, packed, vehicle.body):
        R, place = pose_on(data, vehicle.body, int(link[layout.BODY]))
        extent = float(np.linalg.norm(link[layout.HALF_AXES : layout.HALF_AXES + 3] * R[2]))
        centre = float(place[2] + R[2] @ link[layout.CENTRE : layout.CENTRE + 3])
        found.append((extent, centre, float(link[layout.DISPLACED_MASS])))
    extents, centres, lifts = np.array(found).T
    return extents, centres, lifts


def _balanced(extents: Vector, centres: Vector, shares: Vector, share: float, awash: float) -> float:
    """Height [m] at which that share of the whole volume is under water, by halving, from awash to dry."""
    low, high = awash, float((extents - centres).max())
    while high - low > _HEIGHT_M:
        middle = 0.5 * (low + high)
        t = np.clip(-(middle + centres) / np.maximum(extents, LEAST_EXTENT_M), -1.0, 1.0)
        under = float(shares @ (0.25 * (1.0 + t) ** 2 * (2.0 - t)))
        low, high = (middle, high) if under > share else (low, middle)
    return 0.5 * (low + high)


def weighs_less(vehicle: Vehicle, lighter: float = 0.0) -> bool:
    """Whether a hull weighs less than the water it displaces, once it has let so much weight [N] go."""
    return _weight(vehicle) - lighter < (1.0 - LEAST_LIFT) * _lift(vehicle)


def _weight(vehicle: Vehicle) -> float:
    return vehicle.mass * float(np.linalg.norm(vehicle.gravity))


def _lift(vehicle: Vehicle) -> float:
    return vehicle.displaced_mass * float(np.linalg.norm(vehicle.gravity))
