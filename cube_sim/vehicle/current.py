"""The current of a model while it is used: how the water moves at a place, and how to replace its table."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.laws.current import velocity_at
from cube_sim.vehicle.plugin import layout, packing


def water_velocity(model: mujoco.MjModel, time: float, height: float) -> NDArray[np.float64]:
    """Velocity of the water (3,) [m/s], world axes: the steady current plus the model's table of it.

    Args:
        model: made by `load_model`.
        time: simulated time [s].
        height: z in the world [m].

    Raises:
        ModelError: the model has no water.
    """
    steady = model.opt.wind.copy()
    packed = packing.packed_parameters(model)
    start = int(packed[layout.CURRENT])
    if start < 0:
        return steady
    n_t, n_z = int(packed[start]), int(packed[start + 1])
    times, heights, velocities = np.split(packed[start + 2 : start + 2 + n_t + n_z + 3 * n_t * n_z], [n_t, n_t + n_z])
    return steady + velocity_at(time, height, times, heights, velocities.reshape(-1, 3))


def set_current(model: mujoco.MjModel, velocities: ArrayLike) -> None:
    """Replace the velocities of `water:current`; its times and heights stay.

    Every MjData that steps the model sees them from its next step on.

    Args:
        model: made by `load_model`; changed here.
        velocities: (n_t, n_z, 3) [m/s], world axes, at the model's own n_t times and n_z heights.

    Raises:
        ModelError: the model has no `water:current`, or the shape is another.
    """
    packed = packing.packed_parameters(model)
    start = int(packed[layout.CURRENT])
    if start < 0:
        raise ModelError("water:current", "is not in the model, so it has no times and heights; use model.opt.wind")
    n_t, n_z = int(packed[start]), int(packed[start + 1])
    v = np.asarray(velocities, dtype=float)
    if v.shape != (n_t, n_z, 3) or not np.all(np.isfinite(v)):
        raise ModelError("water:current", f"takes finite velocities of shape ({n_t}, {n_z}, 3), not {v.shape}")
    begin = start + 2 + n_t + n_z
    packed[begin : begin + v.size] = v.ravel()
