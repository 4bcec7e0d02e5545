"""The current of a model while it is used: how water moves at a place, how to replace its table, or still it all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

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
    steady, table = model.opt.wind.copy(), current_table(model)
    return steady if table is None else steady + velocity_at(time, height, *table)


def current_table(model: mujoco.MjModel) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
    """The model's `water:current`: times (n_t,) [s], heights (n_z,) [m], velocities (n_t n_z,3) [m/s], world axes."""
    if not _has_table(model):
        return None
    times, heights, velocities = _table(model)
    return times, heights, velocities.reshape(-1, 3)


def set_current(model: mujoco.MjModel, velocities: ArrayLike) -> None:
    """Replace the velocities of `water:current`; its times and heights stay.

    Every MjData that steps the model sees them from its next step on.

    Args:
        model: made by `load_model`; changed here.
        velocities: (n_t, n_z, 3) [m/s], world axes, at the model's own n_t times and n_z heights.

    Raises:
        ModelError: the model has no `water:current`, or the shape is another.
    """
    if not _has_table(model):
        raise ModelError("water:current", "is not in the model, so it has no times and heights; use model.opt.wind")
    times, heights, table = _table(model)
    v, shape = np.asarray(velocities, dtype=float), (len(times), len(heights), 3)
    if v.shape != shape or not np.all(np.isfinite(v)):
        raise ModelError("water:current", f"takes finite velocities of shape {shape}, not {v.shape}")
    table[:] = v.ravel()


@contextmanager
def still_water(model: mujoco.MjModel) -> Iterator[None]:
    """The model with its water at rest, steady current and table both; afterwards it moves as before.

    Args:
        model: made by `load_model`; changed while the context lasts.

    Raises:
        ModelError: the model has no water.
    """
    table = _table(model)[2] if _has_table(model) else np.zeros(0)
    steady, varying = model.opt.wind.copy(), table.copy()
    model.opt.wind[:], table[:] = 0.0, 0.0
    try:
        yield
    finally:
        model.opt.wind[:], table[:] = steady, varying


def _has_table(model: mujoco.MjModel) -> bool:
    """Whether the model has a `water:current`."""
    return packing.packed_parameters(model)[layout.CURRENT] >= 0.0


def _table(model: mujoco.MjModel) -> list[NDArray[np.float64]]:
    """Times (n_t,) [s], heights (n_z,) [m] and velocities (3 n_t n_z,) [m/s] of `water:current`, as views."""
    packed = packing.packed_parameters(model)
    start = int(packed[layout.CURRENT])
    n_t, n_z = int(packed[start]), int(packed[start + 1])
    return np.split(packed[start + 2 : start + 2 + n_t + n_z + 3 * n_t * n_z], [n_t, n_t + n_z])
