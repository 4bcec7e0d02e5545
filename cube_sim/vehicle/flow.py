"""How the water moves at a place, for whoever records or draws it."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.laws.current import velocity_at
from cube_sim.vehicle.plugin import layout, packing


def water_velocity(model: mujoco.MjModel, time: float, height: float) -> NDArray[np.float64]:
    """Velocity of the water (3,) [m/s], world axes: the steady current and the model's table of it.

    Args:
        model: made by `load_model`.
        time: simulated time [s].
        height: z in the world [m].
    """
    steady = model.opt.wind.copy()
    packed = packing.packed_parameters(model)
    start = int(packed[layout.CURRENT])
    if start < 0:
        return steady
    n_t, n_z = int(packed[start]), int(packed[start + 1])
    times, heights, velocities = np.split(packed[start + 2 : start + 2 + n_t + n_z + 3 * n_t * n_z], [n_t, n_t + n_z])
    return steady + velocity_at(time, height, times, heights, velocities.reshape(-1, 3))
