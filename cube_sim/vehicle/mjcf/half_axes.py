"""The ellipsoid over which a hull's displaced volume is spread where its MJCF does not say one.

It has the proportions of the box around the hull's geoms and the hull's volume.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.mjcf.parameters import HullParameters

_WITHOUT_EXTENT = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)


def half_axes_of(model: mujoco.MjModel, data: mujoco.MjData, hull: int, volume: float) -> NDArray[np.float64]:
    """(3,) half-axes [m] along the body's axes: of a sphere for a hull without geoms, 0 for one without volume too.

    Args:
        model: compiled.
        data: of that model, its kinematics up to date.
        hull: index of the body of the world; what it carries counts.
        volume: displaced [m^3].
    """
    halves = _halves(model, data, hull)
    if not halves.all():
        return np.full(3, (0.75 * volume / pi) ** (1.0 / 3.0))
    if volume == 0.0:
        return halves
    return halves * (volume / (4.0 / 3.0 * pi * halves.prod())) ** (1.0 / 3.0)


def half_axes_of_all(
    model: mujoco.MjModel, data: mujoco.MjData, bodies: Sequence[int], hulls: Sequence[HullParameters]
) -> list[NDArray[np.float64]]:
    """(3,) half-axes of each hull [m]: its parameters', or else those of `half_axes_of`."""
    return [
        half_axes_of(model, data, body, hull.volume) if hull.surface_half_axes is None else hull.surface_half_axes
        for body, hull in zip(bodies, hulls, strict=True)
    ]


def _halves(model: mujoco.MjModel, data: mujoco.MjData, hull: int) -> NDArray[np.float64]:
    """(3,) half the size of the box around the geoms, along the body's axes [m]; 0 without any."""
    its_own = model.body_rootid[model.geom_bodyid] == model.body_rootid[hull]
    geoms = np.flatnonzero(its_own & ~np.isin(model.geom_type, _WITHOUT_EXTENT))
    if not geoms.size:
        return np.zeros(3)
    R = data.xmat[hull].reshape(3, 3)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in geoms:
        axes = R.T @ data.geom_xmat[geom].reshape(3, 3)
        centre = R.T @ (data.geom_xpos[geom] - data.xpos[hull]) + axes @ model.geom_aabb[geom, :3]
        half = np.abs(axes) @ model.geom_aabb[geom, 3:]
        low, high = np.minimum(low, centre - half), np.maximum(high, centre + half)
    return 0.5 * (high - low)
