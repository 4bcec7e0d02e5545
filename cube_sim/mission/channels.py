"""What a run of a scenario records."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.allocation import Status
from cube_sim.control.authority import Authority
from cube_sim.guidance.path import Path
from cube_sim.mission.disturbance import force_events
from cube_sim.mission.navigation import channels_of
from cube_sim.mission.setpoints import setpoints_of
from cube_sim.recording.channels import SUPPLY, WHY_NOT_SUPPLIED, Channel, channel_table
from cube_sim.scenario import Scenario
from cube_sim.scenario.fin_event_block import FinEventBlock
from cube_sim.scenario.phase_blocks import is_timed
from cube_sim.spatial import Matrix
from cube_sim.vehicle.carried_joints import carried_joints
from cube_sim.vehicle.vehicle import Vehicle

PATH_POINTS = 400
"""Points of the polyline by which a recording shows the path."""


def recorded_channels(scenario: Scenario, model: mujoco.MjModel, vehicle: Vehicle) -> tuple[Channel, ...]:
    """The channel table of a run, with the names of the vehicle's thrusters and the scenario's sensors in it.

    Args:
        scenario: to be flown.
        model: that flies.
        vehicle: in it.
    """
    setpoints = setpoints_of(scenario, model, vehicle)
    told = () if setpoints is None else setpoints.told
    joints = carried_joints(model, vehicle.body, vehicle.thrusters.prefix)
    return channel_table(
        vehicle.thrusters.names,
        PATH_POINTS,
        tuple(status.name for status in Status),
        tuple(authority.name for authority in Authority),
        tuple(name for name in SUPPLY if not why_unknown(name, scenario, vehicle)),
        bool(force_events(scenario)),
        tuple(phase.name for phase in scenario.phases),
        is_timed(scenario.phases),
        () if vehicle.fins is None else vehicle.fins.names,
        tuple(each.name for each in told),
        tuple((each.wanted_unit, each.reached_unit) for each in told),
        vehicle.fins.names if vehicle.fins is not None and fins_fail(scenario) else (),
        () if joints is None else joints.positions,
        () if joints is None else joints.velocities,
    ) + channels_of(scenario.navigation)


def fins_fail(scenario: Scenario) -> bool:
    """Whether a scenario has a fin fail."""
    return any(isinstance(event, FinEventBlock) for event in scenario.events)


def why_unknown(quantity: str, scenario: Scenario, vehicle: Vehicle) -> str:
    """Why a quantity of the supply is not modelled, and so not recorded; "" if it is.

    Args:
        quantity: one of `SUPPLY`.
        scenario: to be flown.
        vehicle: with its thrusters.
    """
    thrusters = vehicle.thrusters
    if quantity in ("motor", "energy"):
        stated = bool(np.all(thrusters.power_known))
        return "" if stated else WHY_NOT_SUPPLIED[quantity]
    if quantity == "voltage":
        stated = np.isfinite(thrusters.voltage).all() and len(set(thrusters.voltage.tolist())) == 1
        return "" if stated else WHY_NOT_SUPPLIED[quantity]
    return "" if scenario.battery is not None else WHY_NOT_SUPPLIED[quantity]


def polyline(path: Path) -> Matrix:
    """(PATH_POINTS, 3) points on a whole path, evenly spaced [m], world axes."""
    return np.array([path.at(s).position for s in np.linspace(0.0, path.length, PATH_POINTS)])
