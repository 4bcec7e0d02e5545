"""What the thrusters of a mission can hold at the inflow and voltage of a tick, for allocation and controller."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from cube_sim.control.moment_budget import NOTHING_MOVES, MomentBudget, limit_budget
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.spatial import State, Vector
from cube_sim.vehicle.laws.inflow import Inflow, commands_in_flow, feel_inflow, forces_in_flow
from cube_sim.vehicle.power_supply import PowerSupply, has_voltage_tables
from cube_sim.vehicle.thrusters import Thrusters

if TYPE_CHECKING:
    from cube_sim.control.controller import Controller
    from cube_sim.mission.prepare import Mission

NO_CURRENT = np.zeros(3)
"""Of the controllers that estimate none which the limits could follow [m/s]."""


def inflow_of(thrusters: Thrusters, supply: PowerSupply) -> Inflow:
    """The inflow at thrusters, before it has been felt.

    Args:
        thrusters: as the controller believes them.
        supply: what feeds them; its tables are theirs.
    """
    of, tables = thrusters.propellers, supply.tables
    nominal = tables.limits  # of those that follow the voltage, moved on by the supply
    nominal[~tables.known] = thrusters.limits[~tables.known]
    varies = bool(of.turns.any()) or supply.by_tables
    m = len(nominal)
    turning = of.turns.copy(), of.rows.copy(), of.points.copy()
    return Inflow(varies, *turning, tables.known, tables.curves, tables.starts, nominal, np.zeros(m), nominal.copy())


def limits_move(thrusters: Thrusters, model: mujoco.MjModel, battery: bool) -> bool:
    """Whether what thrusters can hold follows more than the supply's share of their force.

    Args:
        thrusters: as the controller believes them.
        model: that they are of.
        battery: whether one feeds them.
    """
    return bool(thrusters.propellers.turns.any()) or (battery and has_voltage_tables(model, thrusters))


def feel(mission: Mission, known: State) -> None:
    """Let limits of allocation and controller follow what is known of a vehicle's motion and its supply."""
    inflow, share = mission.inflow, mission.supply.force_ratio
    if not inflow.varies:
        return
    current = current_of(mission.controller)
    feel_inflow(inflow, known.rotation, known.velocity, known.rates, current, share)
    mission.allocator.limit(inflow.limits, mission.scenario.allocation.dead_zone_margin)
    limit_budget(budget_of(mission.controller), inflow.limits)


def current_of(controller: Controller) -> Vector:
    """The current (3,) that the inflow is reckoned with [m/s], world axes."""
    return controller.current if isinstance(controller, PathFollower) else NO_CURRENT


def budget_of(controller: Controller) -> MomentBudget:
    """What of a controller follows the limits."""
    return controller.moment if isinstance(controller, PathFollower | PlanarFollower) else NOTHING_MOVES


def commands_for(mission: Mission, forces: Vector) -> Vector:
    """Commands (m,) for forces (m,) to ask of the thrusters [N], as allocation and supply of the moment have them."""
    inflow, thrusters = mission.inflow, mission.vehicle.thrusters
    if not inflow.varies or mission.supply.force_ratio == 0.0:
        return thrusters.command(forces)
    return commands_in_flow(inflow, mission.supply.force_ratio, np.asarray(forces, float))


def forces_of(mission: Mission, commands: Vector) -> Vector:
    """Steady forces (m,) [N] that whole thrusters make of commands (m,), at the supply of the moment."""
    inflow, thrusters, share = mission.inflow, mission.vehicle.thrusters, mission.supply.force_ratio
    if not inflow.varies:
        return share * thrusters.force(commands)
    return forces_in_flow(inflow, share, np.asarray(commands, float))
