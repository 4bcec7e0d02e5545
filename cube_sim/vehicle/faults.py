"""Faults and supply of a model's thrusters while it is used, without compiling it again.

Each function writes a few numbers inside the model (`cube_sim.vehicle.plugin.layout`). Every MjData that steps the
model sees them from its next step on. Copy the model first where only some simulations are to have the fault.
"""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.errors import ModelError
from cube_sim.nearest import among
from cube_sim.vehicle.plugin import layout, packing


def set_efficiency(model: mujoco.MjModel, thruster: str, efficiency: float) -> None:
    """Let a thruster give a fraction of its force: 1 is whole, 0 is dead. A stuck one is freed.

    A fraction is what its propeller loses: the motor turns and draws as before. The motor of a dead thruster draws
    nothing.

    Args:
        model: made by `load_model`; changed here.
        thruster: name of its actuator.
        efficiency: fraction of the force, 0 to 1.

    Raises:
        ModelError: no such thruster, or an efficiency outside [0, 1].
    """
    if not 0.0 <= efficiency <= 1.0:
        raise ModelError(thruster, f"efficiency {efficiency:g} is outside [0, 1]")
    start = curve_start(model, thruster)
    packed = packing.packed_parameters(model)
    packed[start + layout.EFFICIENCY] = efficiency
    packed[start + layout.STUCK] = np.nan


def set_stuck(model: mujoco.MjModel, thruster: str, force: float) -> None:
    """Let a thruster hold a force whatever it is commanded, until `set_efficiency` frees it.

    Args:
        model: made by `load_model`; changed here.
        thruster: name of its actuator.
        force: at the voltage of its characteristic [N]; another supply scales it as it scales any other force.

    Raises:
        ModelError: no such thruster, or a force it could never give.
    """
    start = curve_start(model, thruster)
    packed = packing.packed_parameters(model)
    n = int(packed[start + layout.POINTS])
    forces = packed[start + layout.CURVE + n : start + layout.CURVE + 2 * n]
    if not forces[0] <= force <= forces[-1]:
        raise ModelError(thruster, f"cannot be stuck at {force:g} N; it gives {forces[0]:g} to {forces[-1]:g} N")
    packed[start + layout.STUCK] = force


def set_supply(model: mujoco.MjModel, thruster: str, ratio: float) -> None:
    """Feed a thruster with another voltage.

    A propeller's speed n follows the voltage, and its thrust is F = k n |n|. So forces scale with ratio^2. A thruster
    whose curves are known at several voltages has the one of this voltage.

    Args:
        model: made by `load_model`; changed here.
        thruster: name of its actuator.
        ratio: supply voltage over the voltage its characteristic was measured at; 0 is no supply.

    Raises:
        ModelError: no such thruster, or a ratio that is negative or not finite.
    """
    if not 0.0 <= ratio < np.inf:
        raise ModelError(thruster, f"supply ratio {ratio:g} is negative or not finite")
    packed, start = packing.packed_parameters(model), curve_start(model, thruster)
    tables = int(packed[start + layout.TABLES])
    packed[start + layout.SUPPLY] = ratio**2 if tables < 0 else float(ratio > 0.0)
    if tables >= 0 and ratio > 0.0:
        from cube_sim.vehicle.laws.voltage_law import put_voltage  # only here: it loads the compiler

        put_voltage(packed, tables, start, layout.CURVE, layout.POWER, ratio * packed[start + layout.VOLTAGE])


def curve_start(model: mujoco.MjModel, thruster: str) -> int:
    """Start of a thruster's curve record."""
    table = int(packing.packed_parameters(model)[layout.THRUSTERS])
    starts = packing.packed_parameters(model)[table : table + model.nu]
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, thruster)
    if index < 0 or starts[index] < 0.0:
        names = [model.actuator(i).name for i in range(model.nu) if starts[i] >= 0.0]
        raise ModelError(thruster, f"is no thruster; the model has {among(thruster, names)}")
    return int(starts[index])
