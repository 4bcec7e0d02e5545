"""One control period: state -> estimate -> wrench -> thruster forces -> commands -> one row per channel."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

import numpy as np

from cube_sim.allocation import Allocation, Status
from cube_sim.allocation.fin_shares import with_missed
from cube_sim.control.controller import Decision
from cube_sim.control.following import FOLLOWED
from cube_sim.flight.action import Action
from cube_sim.flight.rows import (
    TickRows,
    write_actuation,
    write_disturbance,
    write_fins,
    write_joints,
    write_motion,
    write_setpoints,
)
from cube_sim.guidance.view_record import record_of
from cube_sim.mission import Mission
from cube_sim.mission.disturbance import pushes_of
from cube_sim.mission.fault_response import record_actuation
from cube_sim.mission.fins import FinAnswer
from cube_sim.mission.moment import commands_for, feel, forces_of
from cube_sim.mission.setpoints import command_others, parts_of
from cube_sim.mission.supply import allocate_at
from cube_sim.recording.signal_store import SignalStore
from cube_sim.spatial import State, Vector
from cube_sim.tuples import angle_of_turn
from cube_sim.vehicle.current import water_velocity
from cube_sim.vehicle.laws.push import push_wrench
from cube_sim.vehicle.pushes import hull_number
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


def tick(
    mission: Mission,
    rows: TickRows,
    store: SignalStore,
    t: float,
    applied: Vector,
    action: Action,
    known: State | None = None,
) -> Tick:
    """One control period up to the thruster commands.

    Args:
        mission: whose MuJoCo data are up to date at t.
        rows: one of each channel, that of the supply written; the others are written here.
        store: gets the rows, and what the navigation records.
        t: simulated time [s].
        applied: (6,) wrench commanded over the tick before.
        action: in place of the loop's own answer.
        known: the state the controller is to see; None where it has not been estimated yet.

    Raises:
        NotANumberError: the controller's answer is not finite.
    """
    state = read_state(mission.vehicle, mission.data)
    if mission.estimation is None:
        known = state
    elif known is None:
        known = mission.estimation.estimate(state, store, t)
    feel(mission, known)
    ratio = mission.force_ratio
    if mission.inflow.varies:
        record_actuation(mission, store, t, ratio, mission.inflow.limits[None])
    decision = mission.controller.decide(known, applied, mission.scenario.control_period_s, ratio)
    if action.wrench is not None:
        decision = decision._replace(wrench=action.wrench, secondary=np.zeros(6))
    wrench, quaternion, error = decision.wrench, decision.quaternion, decision.view.error
    if not isfinite(wrench @ wrench + quaternion @ quaternion + error @ error):
        raise NotANumberError("the controller's answer is not a number")
    allocator, thrusters = mission.allocator, mission.vehicle.thrusters
    commands = action.commands if action.forces is None else commands_for(mission, action.forces)
    steered = None if commands is not None else _steer(mission, decision, known)
    if commands is not None:
        allocation = allocator.made_by(forces_of(mission, commands))
        decision = decision._replace(wrench=allocation.wrench, secondary=np.zeros(6))
    else:
        left = decision.wrench if steered is None else steered.rest
        allocation, force = allocate_at(ratio, allocator, left, decision.secondary)
        if steered is not None:
            residual, status = with_missed(allocation.residual, int(allocation.status), steered.missed)
            made = allocation.wrench + steered.made
            allocation = allocation._replace(wrench=made, residual=residual, status=Status(status))
        if mission.fault_finding is not None:
            force = mission.fault_finding.probed(force)
        commands = commands_for(mission, force)
    if mission.fins is not None:
        turned = np.zeros(len(mission.fins.fins.names)) if steered is None else steered.wanted
        made = np.zeros(6) if steered is None else steered.made
        mission.data.ctrl[mission.fins.fins.actuators] = turned
        write_fins(rows, 0, t, turned, mission.data.act[mission.fins.fins.activations], made)
    mission.data.ctrl[thrusters.actuators] = commands
    if mission.setpoints is not None:
        parts = parts_of(mission.setpoints, mission.data)
        command_others(parts, t, mission.data.ctrl)
        write_setpoints(rows, 0, t, parts, mission.data.act)
    if mission.joints is not None:
        write_joints(rows, 0, t, mission.joints.places, mission.data.qpos, mission.data.qvel)
    # The errors recorded are those of the true state, not of the estimate.
    attitude_error = decision.attitude_error if known is state else angle_of_turn(decision.quaternion, state.quaternion)
    _write(mission, rows, t, state, decision, attitude_error, allocation, commands)
    store.extend(t, t, rows.named())
    return Tick(decision, allocation, known)


def _steer(mission: Mission, decision: Decision, known: State) -> FinAnswer | None:
    """What the fins are asked for; None for a vehicle that has none."""
    if mission.fins is None:
        return None
    deflections = mission.data.act[mission.fins.fins.activations]
    water = decision.current if decision.fins_water is None else decision.fins_water
    seen = decision.wrench, known, water, deflections, mission.force_ratio
    steer = decision.fins_water is not None
    return mission.fins.share(mission.fins.parts(mission.allocator, mission.events.fins_told, steer), *seen)


def _write(
    mission: Mission,
    rows: TickRows,
    t: float,
    state: State,
    decision: Decision,
    attitude_error: float,
    allocation: Allocation,
    commands: Vector,
) -> None:
    """One row per channel."""
    followed = np.zeros(1, FOLLOWED)
    followed["wrench"], followed["velocity"], followed["rates"] = decision.wrench, decision.velocity, decision.rates
    seen = record_of(decision.view)
    seen["remaining"] = decision.remaining
    water = water_velocity(mission.model, t, state.position[2])
    vectors = decision.quaternion, attitude_error, decision.disturbance, decision.current, water
    numbers = np.concatenate([state.position, state.quaternion, state.rotation.ravel(), state.velocity, state.rates])
    write_motion(rows, 0, t, numbers, seen, followed, *vectors)
    pushes = pushes_of(mission.scenario, mission.model)
    if pushes is not None:
        number = hull_number(mission.model, mission.vehicle.body)
        write_disturbance(rows, 0, t, push_wrench(pushes, float(number), state.rotation, t, 0.0))
    write_actuation(
        rows,
        0,
        t,
        allocation.wrench,
        allocation.force,
        commands,
        mission.data.actuator_force[mission.vehicle.thrusters.actuators],
        allocation.subset.astype(np.float64),
        float(allocation.residual),
        float(allocation.cost),
        int(allocation.status),
        mission.events.health.efficiency,
        mission.allocator.health.efficiency,
        float(decision.authority),
    )
