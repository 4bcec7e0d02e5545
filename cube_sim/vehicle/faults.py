"""The state a model's thrusters and current are in while it is used: faults and supply, without compiling again.

Each function writes a few numbers inside the model (`cube_sim.vehicle.plugin.layout`); every MjData that steps it
sees them from its next step on. Copy the model first where only some simulations are to have the fault.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.plugin import layout, packing


def set_efficiency(model: mujoco.MjModel, thruster: str, efficiency: float) -> None:
    """A thruster that gives a fraction of its force: 1 is whole, 0 is dead. Frees it when it was stuck.

    A fraction is a propeller's loss: the motor turns as before and draws as before. A dead motor draws nothing.

    Raises:
        ModelError: no such thruster, or an efficiency outside [0, 1].
    """
    if not 0.0 <= efficiency <= 1.0:
        raise ModelError(thruster, f"efficiency {efficiency:g} is outside [0, 1]")
    start = _curve(model, thruster)
    packed = packing.packed_parameters(model)
    packed[start + layout.EFFICIENCY] = efficiency
    packed[start + layout.STUCK] = np.nan


def whole_forces(model: mujoco.MjModel, thrusters: Sequence[str], forces: ArrayLike) -> NDArray[np.float64]:
    """(m,) forces [N] that whole propellers would give where these give (m,) `forces` [N]; 0 for a dead motor.

    Electrical power follows from these: what a damaged propeller loses, its motor draws all the same.
    """
    F = np.array(forces, dtype=float)
    packed = packing.packed_parameters(model)
    for i, name in enumerate(thrusters):
        start = _curve(model, name)
        if np.isnan(packed[start + layout.STUCK]):
            efficiency = packed[start + layout.EFFICIENCY]
            F[i] = F[i] / efficiency if efficiency > 0.0 else 0.0
    return F


def set_stuck(model: mujoco.MjModel, thruster: str, force: float) -> None:
    """A thruster that holds `force` [N] whatever it is commanded, until `set_efficiency` frees it.

    The force is that at the voltage of its characteristic; another supply scales it as it scales any other.

    Raises:
        ModelError: no such thruster, or a force it could never give.
    """
    start = _curve(model, thruster)
    packed = packing.packed_parameters(model)
    n = int(packed[start + layout.POINTS])
    forces = packed[start + layout.CURVE + n : start + layout.CURVE + 2 * n]
    if not forces[0] <= force <= forces[-1]:
        raise ModelError(thruster, f"cannot be stuck at {force:g} N; it gives {forces[0]:g} to {forces[-1]:g} N")
    packed[start + layout.STUCK] = force


def set_supply(model: mujoco.MjModel, thruster: str, ratio: float) -> None:
    """Supply voltage over the voltage the characteristic was measured at; 0 is no supply.

    Propeller speed follows voltage and thrust its square, so forces scale with ratio^2 (F = k n |n|).

    Raises:
        ModelError: no such thruster, or a ratio that is negative or not finite.
    """
    if not 0.0 <= ratio < np.inf:
        raise ModelError(thruster, f"supply ratio {ratio:g} is negative or not finite")
    packing.packed_parameters(model)[_curve(model, thruster) + layout.SUPPLY] = ratio**2


def set_current(model: mujoco.MjModel, velocities: ArrayLike) -> None:
    """Replace the velocities of `water:current` (n_t, n_z, 3) [m/s] on the model's own times and heights.

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


def _curve(model: mujoco.MjModel, thruster: str) -> int:
    """Start of a thruster's curve record."""
    table = int(packing.packed_parameters(model)[layout.THRUSTERS])
    starts = packing.packed_parameters(model)[table : table + model.nu]
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, thruster)
    if index < 0 or starts[index] < 0.0:
        names = [model.actuator(i).name for i in range(model.nu) if starts[i] >= 0.0]
        raise ModelError(thruster, f"is no thruster; the model has {', '.join(names)}")
    return int(starts[index])
