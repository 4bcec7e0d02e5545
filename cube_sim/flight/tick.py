"""One control period: state -> estimate -> wrench -> thruster forces -> commands -> one row per channel."""

from __future__ import annotations

from math import hypot, isfinite
from typing import NamedTuple

import numpy as np

from cube_sim.allocation import Allocation
from cube_sim.control.controller import Decision
from cube_sim.flight.action import Action
from cube_sim.mission import Mission
from cube_sim.mission.supply import allocate_at
from cube_sim.recording.signal_store import SignalStore
from cube_sim.spatial import State, Vector, angle_between, quaternion_from_rotation
from cube_sim.vehicle.current import water_velocity
from cube_sim.vehicle.state import read_state


class NotANumberError(Exception):
    """The controller has no answer to the state it sees."""


class Tick(NamedTuple):
    """What a control period came to.

    Attributes:
        decision: of the controller, with the wrench that was demanded.
        allocation: of that wrench.
        known: the state the controller saw.
    """

    decision: Decision
    allocation: Allocation
    known: State


def tick(mission: Mission, store: SignalStore, t: float, applied: Vector, action: Action) -> Tick:
    """One control period up to the thruster commands.

    Args:
        mission: whose MuJoCo data are up to date at t.
        store: gets one row per channel.
        t: simulated time [s].
        applied: (6,) wrench commanded over the tick before.
        action: in place of the loop's own answer.

    Raises:
        NotANumberError: the controller's answer is not finite.
    """
    state = read_state(mission.vehicle, mission.data)
    known = state if mission.estimation is None else mission.estimation.estimate(state, mission.data, store, t)
    decision = mission.controller.decide(known, applied, mission.scenario.control_period_s, mission.supply.force_ratio)
    if action.wrench is not None:
        decision = decision._replace(wrench=action.wrench, secondary=np.zeros(6))
    wrench, quaternion, error = decision.wrench, decision.quaternion, decision.view.error
    if not isfinite(wrench @ wrench + quaternion @ quaternion + error @ error):
        raise NotANumberError("the controller's answer is not a number")
    allocator, thrusters, ratio = mission.allocator, mission.vehicle.thrusters, mission.supply.force_ratio
    commands = action.commands if action.forces is None else thrusters.command(action.forces)
    if commands is not None:
        allocation = allocator.made_by(ratio * thrusters.force(commands))
        decision = decision._replace(wrench=allocation.wrench, secondary=np.zeros(6))
    else:
        allocation, force = allocate_at(ratio, allocator, decision.wrench, decision.secondary)
        if mission.fault_finding is not None:
            force = mission.fault_finding.probed(force)
        commands = thrusters.command(force)
    mission.data.ctrl[thrusters.actuators] = commands
    if mission.fault_finding is not None:
        mission.fault_finding.commanded(commands)
    _record(mission, store, t, state, known, decision, allocation, commands)
    return Tick(decision, allocation, known)


def _record(
    mission: Mission,
    store: SignalStore,
    t: float,
    state: State,
    known: State,
    decision: Decision,
    allocation: Allocation,
    commands: Vector,
) -> None:
    """One row per channel."""
    store.append("pose", t, state.position, state.quaternion)
    store.append("velocity", t, state.velocity, state.rates)
    point, error, attitude_error = decision.view.point, decision.view.error, decision.attitude_error
    if known is not state:
        # The errors recorded are those of the true state, not of the estimate.
        error = (state.position - point.position) @ point.rotation
        attitude_error = angle_between(decision.quaternion, state.quaternion)
    s1, y1, z1 = error
    orientation = quaternion_from_rotation(point.rotation)
    store.append("target", t, decision.view.arc_length, decision.remaining, point.position, orientation)
    store.append("path_error", t, s1, (y1, z1), hypot(y1, z1), attitude_error)
    store.append("reference", t, decision.velocity, decision.rates, decision.quaternion)
    store.append("wrench", t, decision.wrench, allocation.wrench, decision.disturbance)
    store.append("allocation", t, allocation.residual, allocation.cost, allocation.status, allocation.subset)
    produced = mission.data.actuator_force[mission.vehicle.thrusters.actuators]
    store.append("thrusters", t, allocation.force, commands, produced)
    believed = mission.allocator.health.efficiency
    store.append("health", t, mission.events.health.efficiency, believed, decision.authority)
    water = water_velocity(mission.model, t, state.position[2])
    store.append("water", t, water, decision.current)
