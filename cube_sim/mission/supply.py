"""The supply a scenario gives its thrusters, and an allocation that knows what it leaves of their force."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.allocation import Allocation, FaultTolerant
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.scenario import Loaded
from cube_sim.spatial import Vector
from cube_sim.vehicle.battery import Battery
from cube_sim.vehicle.power_supply import PowerSupply
from cube_sim.vehicle.vehicle import Vehicle


def supply_of(loaded: Loaded, model: mujoco.MjModel, vehicle: Vehicle) -> PowerSupply:
    """The `battery` block's battery, or without one the voltage of the characteristics.

    Raises:
        ScenarioError: the model does not say enough of its thrusters for a battery; with position.
    """
    block = loaded.scenario.battery
    if block is None:
        return PowerSupply(model, vehicle.thrusters)
    empty, full = block.open_circuit_V
    battery = Battery(full, block.resistance_ohm, empty, block.capacity_Wh * 3600.0)
    try:
        return PowerSupply(model, vehicle.thrusters, battery, block.charge)
    except ModelError as error:
        raise ScenarioError([loaded.mistake("battery", f"{loaded.scenario.model}: {error}")]) from None


def allocate_at(
    force_ratio: float, allocator: FaultTolerant, wrench: Vector, secondary: Vector | None = None
) -> tuple[Allocation, Vector]:
    """Forces for a demand while every thruster gives a share of the force of its characteristic.

    All allowed sets shrink by the same factor. So the answer is the factor times the answer for a demand that is larger
    by its inverse. It is exact, within the limits of this moment, and no allocator has to be built anew.

    Args:
        force_ratio: the share, (V / V_n)^2.
        allocator: at V_n.
        wrench: (6,) [N, N m].
        secondary: the part (6,) of it that gives way, as in `FaultTolerant.allocate`.

    Returns:
        The allocation, and the forces (m,) [N] to ask of the thrusters as if they were whole and fed with V_n.
    """
    if force_ratio == 1.0:
        whole = allocator.allocate(wrench, secondary)
        return whole, allocator.force_if_whole(whole.force)
    if force_ratio == 0.0:
        return allocator.without_force(wrench), np.zeros(allocator.count)
    part = allocator.allocate(wrench / force_ratio, None if secondary is None else secondary / force_ratio)
    scaled = part._replace(
        force=part.force * force_ratio,
        wrench=part.wrench * force_ratio,
        wrench_error=part.wrench_error * force_ratio,
        residual=part.residual * force_ratio,
        cost=part.cost * (force_ratio * force_ratio),
    )
    return scaled, allocator.force_if_whole(part.force)
