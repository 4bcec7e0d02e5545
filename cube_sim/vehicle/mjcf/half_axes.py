"""The ellipsoid over which a hull's, or a link's, displaced volume is spread where its MJCF does not say one.

It has the proportions of the box around the body's geoms and the body's volume. Geoms of what a body carries count as
its own, but for those of links that have water of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.mjcf.water_body import WaterBody

_WITHOUT_EXTENT = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)


def half_axes_of_all(
    model: mujoco.MjModel, data: mujoco.MjData, indices: Sequence[int], bodies: Sequence[WaterBody]
) -> list[NDArray[np.float64]]:
    """(3,) half-axes of each body in the water [m]: its parameters', or else those of its geoms and volume.

    Without geoms it is a sphere; without volume too, nothing.

    Args:
        model: compiled.
        data: of that model, its kinematics up to date.
        indices: of all bodies in the water.
        bodies: what the MJCF says of each.
    """
    owners = _owners(model, indices)
    return [
        _half_axes(_halves(model, data, index, owners), body.volume)
        if body.surface_half_axes is None
        else body.surface_half_axes
        for index, body in zip(indices, bodies, strict=True)
    ]


def _owners(model: mujoco.MjModel, indices: Sequence[int]) -> NDArray[np.int_]:
    """(nbody,) for each body the one in the water that it is, or that carries it most closely; 0 for none."""
    owners = np.zeros(model.nbody, dtype=int)
    for body in range(1, model.nbody):
        owners[body] = body if body in indices else owners[model.body_parentid[body]]
    return owners


def _half_axes(halves: NDArray[np.float64], volume: float) -> NDArray[np.float64]:
    if not halves.all():
        return np.full(3, (0.75 * volume / pi) ** (1.0 / 3.0))
    if volume == 0.0:
        return halves
    return halves * (volume / (4.0 / 3.0 * pi * halves.prod())) ** (1.0 / 3.0)


def _halves(model: mujoco.MjModel, data: mujoco.MjData, body: int, owners: NDArray[np.int_]) -> NDArray[np.float64]:
    """(3,) half the size of the box around the geoms, along the body's axes [m]; 0 without any."""
    its_own = owners[model.geom_bodyid] == body
    geoms = np.flatnonzero(its_own & ~np.isin(model.geom_type, _WITHOUT_EXTENT))
    if not geoms.size:
        return np.zeros(3)
    R = data.xmat[body].reshape(3, 3)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for geom in geoms:
        axes = R.T @ data.geom_xmat[geom].reshape(3, 3)
        centre = R.T @ (data.geom_xpos[geom] - data.xpos[body]) + axes @ model.geom_aabb[geom, :3]
        half = np.abs(axes) @ model.geom_aabb[geom, 3:]
        low, high = np.minimum(low, centre - half), np.maximum(high, centre + half)
    return 0.5 * (high - low)
