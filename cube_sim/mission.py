"""A loaded scenario turned into the objects the loop drives."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from math import inf, radians
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.actuators import Actuators
from cube_sim.allocation import Status
from cube_sim.allocation.factory import WrenchAllocator, is_exact, make_allocator
from cube_sim.control.attitude import AlongPath, AttitudeMode, FixedAttitude
from cube_sim.control.authority import Authority, capability
from cube_sim.control.controller import Controller
from cube_sim.control.diagnosis import Diagnosis
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops
from cube_sim.control.path_follower import PathFollower
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.events import Events
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.path import Path
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.planar_mission import planar_follower
from cube_sim.recording.channels import Channel, channel_table
from cube_sim.scenario import Loaded, Scenario, schema
from cube_sim.scenario.check_blocks import SignalCheck
from cube_sim.scenario.event_blocks import ThrusterEvent
from cube_sim.scenario_path import is_level, laps_of, path_of, speed_of
from cube_sim.spatial import quaternion_from_euler, rotation_from_quaternion
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.vehicle import Vehicle, hull_names

PATH_POINTS = 400
"""Points of the polyline by which a recording shows the path."""


@dataclass(frozen=True)
class Mission:
    """Everything a run needs, ready at time 0.

    Attributes:
        scenario: what was asked for.
        model: the compiled model with water.
        data: its state, at the scenario's initial condition.
        vehicle: the hull that follows the path.
        path: the path.
        controller: state to wrench.
        actuators: wrench to thruster forces.
        events: what happens on the way.
        diagnosis: finds thruster faults, None when the controller is told of them or ignores them.
        channels: what will be recorded.
    """

    scenario: Scenario
    model: mujoco.MjModel
    data: mujoco.MjData
    vehicle: Vehicle
    path: Path
    controller: Controller
    actuators: Actuators
    events: Events
    diagnosis: Diagnosis | None
    channels: tuple[Channel, ...]


def prepare(loaded: Loaded) -> Mission:
    """Build a mission; nothing is written.

    Raises:
        ScenarioError: the model does not fit the scenario; with position.
    """
    scenario = loaded.scenario
    model, vehicle = _vehicle(loaded)
    path = path_of(loaded)
    channels = channel_table(
        vehicle.thrusters.names,
        PATH_POINTS,
        tuple(status.name for status in Status),
        tuple(authority.name for authority in Authority),
    )
    _require_signals(loaded, channels)
    _require_possible_events(loaded, vehicle)
    return Mission(
        scenario=scenario,
        model=model,
        data=_initial_state(model, vehicle, scenario),
        vehicle=vehicle,
        path=path,
        controller=_controller(loaded, model, path, vehicle),
        actuators=_actuators(vehicle, scenario.allocation),
        events=Events(scenario.events, model, vehicle),
        diagnosis=_diagnosis(vehicle, scenario) if scenario.control.faults == "diagnosed" else None,
        channels=channels,
    )


def _require_signals(loaded: Loaded, channels: tuple[Channel, ...]) -> None:
    """Find the signals no run will record before the run, not after it."""
    widths = {f"{channel.name}.{field.name}": field.width for channel in channels for field in channel.fields}
    mistakes = []
    for i, check in enumerate(loaded.scenario.checks):
        if not isinstance(check, SignalCheck):
            continue
        if check.signal not in widths:
            near = get_close_matches(check.signal, widths, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(widths)}"
            mistakes.append(loaded.mistake(f"checks.{i}.signal", f"no signal '{check.signal}' is recorded, {hint}"))
        elif check.component is not None and check.component >= widths[check.signal]:
            last = widths[check.signal] - 1
            mistakes.append(loaded.mistake(f"checks.{i}.component", f"{check.signal} has columns 0 to {last}"))
    if mistakes:
        raise ScenarioError(mistakes)


def _controller(loaded: Loaded, model: mujoco.MjModel, path: Path, vehicle: Vehicle) -> Controller:
    scenario = loaded.scenario
    guidance, control, dynamics = scenario.guidance, scenario.control, vehicle.dynamics
    if control.law == "planar_lapierre_2007":
        return planar_follower(loaded, model, path, vehicle)
    limit, time = guidance.target_speed_limit_m_s, control.disturbance_time_s
    whole = capability(vehicle.actuation_matrix)
    if whole.authority is Authority.LEVEL and not is_level(path):
        text = "this path climbs or sinks, and the vehicle has thrusters for a level plane only"
        raise ScenarioError([loaded.mistake("path", text)])
    return PathFollower(
        target=VirtualTarget(
            path, guidance.target_gain_per_s, inf if limit is None else limit, laps=laps_of(scenario.path)
        ),
        approach=Approach(
            speed_of(guidance, path),
            radians(guidance.approach_angle_deg),
            guidance.approach_gain_per_m,
            guidance.stop_time_s if guidance.stop_at_end else None,
        ),
        attitude=_attitude(control.attitude),
        loops=MotionLoops(dynamics, control.velocity_time_s, control.attitude_time_s, control.rate_time_s),
        balancing_time=0.5 * control.attitude_time_s,
        observer=None if time is None else DisturbanceObserver(dynamics, time),
        capability=whole if whole.authority is Authority.LEVEL else capability(np.eye(6)),
    )


def _vehicle(loaded: Loaded) -> tuple[mujoco.MjModel, Vehicle]:
    scenario = loaded.scenario
    try:
        model = load_model(scenario.model)
        vehicle = _chosen_hull(loaded, model)
        zone = scenario.thrusters.dead_zone_N
        if zone is not None:
            # Every thruster gets it, whether the model states dead zones per hull or per thruster.
            owners = (vehicle.name, *vehicle.thrusters.names)
            model = load_model(scenario.model, {f"{owner}:thruster_dead_zone": zone for owner in owners})
            vehicle = Vehicle.from_model(model, vehicle.name)
    except ModelError as error:
        where = "thrusters.dead_zone_N" if error.element.endswith("thruster_dead_zone") else "model"
        raise ScenarioError([loaded.mistake(where, str(error))]) from None
    if not vehicle.thrusters.names:
        where = "model" if scenario.vehicle is None else "vehicle"
        raise ScenarioError([loaded.mistake(where, f"{scenario.model}: '{vehicle.name}' has no thruster")])
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{scenario.physics.integrator.upper()}")
    model.opt.timestep = scenario.physics.step_s
    model.opt.wind[:] = scenario.current_m_s
    # A state that has left the real numbers must end the run, not silently start it again.
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    return model, vehicle


def _chosen_hull(loaded: Loaded, model: mujoco.MjModel) -> Vehicle:
    hulls, name = hull_names(model), loaded.scenario.vehicle
    if name is None and len(hulls) > 1:
        text = f"the model has several hulls: {', '.join(hulls)}; say which one flies, for example vehicle: {hulls[0]}"
        raise ScenarioError([loaded.mistake("model", text)])
    if name is not None and name not in hulls:
        raise ScenarioError([loaded.mistake("vehicle", f"no hull '{name}'; the model has {', '.join(hulls)}")])
    return Vehicle.from_model(model, name)


def _initial_state(model: mujoco.MjModel, vehicle: Vehicle, scenario: Scenario) -> mujoco.MjData:
    data = mujoco.MjData(model)
    initial = scenario.initial
    q = quaternion_from_euler(*np.radians(initial.attitude_deg))
    at, dof = vehicle.qpos_address, vehicle.dof_address
    data.qpos[at : at + 3] = initial.position_m
    data.qpos[at + 3 : at + 7] = q
    data.qvel[dof : dof + 3] = rotation_from_quaternion(q) @ np.array(initial.velocity_m_s)
    data.qvel[dof + 3 : dof + 6] = np.radians(initial.rates_deg_s)
    return data


def _attitude(block: schema.Attitude) -> AttitudeMode:
    match block:
        case schema.AlongPath():
            return AlongPath()
        case schema.FixedAttitude():
            return FixedAttitude(quaternion_from_euler(*np.radians(block.attitude_deg)))


def _actuators(vehicle: Vehicle, block: schema.Allocation) -> Actuators:
    thrusters = vehicle.thrusters

    def build(A: NDArray[np.float64], limits: NDArray[np.float64], which: NDArray[np.int_]) -> WrenchAllocator:
        options: dict[str, Any] = {
            "allow_off": block.allow_off,
            "power_coefficients": thrusters.power_coefficients[which],
        }
        if is_exact(block.method):
            weights = np.ones(6)
            weights[3:] = block.torque_weight
            options |= {
                "objective": block.objective,
                "wrench_weights": weights,
                "unattainable": block.unattainable,
                "reversal_penalty": block.reversal_penalty_N2,
                "change_limit": block.change_limit_N,
            }
        if block.objective.startswith("reactivity"):
            options["reactivity"] = thrusters.reactivity[which]
        return make_allocator(block.method, A, limits, options)

    limits = clear_of_dead_zone(thrusters.limits, block.dead_zone_margin)
    return Actuators(vehicle.actuation_matrix, limits, build)


def _diagnosis(vehicle: Vehicle, scenario: Scenario) -> Diagnosis:
    """Half a second of evidence, and differences beyond the dead zone, where no motor's force is certain."""
    thrusters = vehicle.thrusters
    threshold = max(0.5, 1.2 * float(np.abs(thrusters.limits[:, 1:3]).max()))
    return Diagnosis(thrusters.lag_s, 0.5, threshold, scenario.control_period_s)


def _require_possible_events(loaded: Loaded, vehicle: Vehicle) -> None:
    """Find events that cannot happen to this vehicle before the run."""
    thrusters, duration = vehicle.thrusters, loaded.scenario.duration_s
    mistakes = []
    for i, event in enumerate(loaded.scenario.events):
        if event.at_s > duration:
            text = f"{event.at_s:g} s is after the end of the run at {duration:g} s"
            mistakes.append(loaded.mistake(f"events.{i}.at_s", text, because="duration_s"))
        if not isinstance(event, ThrusterEvent):
            continue
        for j, name in enumerate(event.thrusters):
            if name not in thrusters.names:
                text = f"no thruster '{name}'; the model has {', '.join(thrusters.names)}"
                mistakes.append(loaded.mistake(f"events.{i}.thrusters.{j}", text))
            elif event.force_N is not None:
                low, _, _, high = thrusters.limits[thrusters.names.index(name)]
                if not low <= event.force_N <= high:
                    text = f"{name} cannot be stuck at {event.force_N:g} N; it gives {low:g} to {high:g} N"
                    mistakes.append(loaded.mistake(f"events.{i}.force_N", text))
    if mistakes:
        raise ScenarioError(mistakes)


def clear_of_dead_zone(limits: NDArray[np.float64], margin: float) -> NDArray[np.float64]:
    """Limits whose dead zones are wider by the share `margin`, never beyond saturation.

    A lagging motor approaches a constant command from inside: commanded exactly onto the edge of its dead zone it
    would never start, and close to the edge it starts late, after lag * ln(1 / margin).

    Args:
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N].
        margin: share of F_DZ.
    """
    wider = limits.copy()
    wider[:, 1] = np.maximum(limits[:, 0], limits[:, 1] * (1.0 + margin))
    wider[:, 2] = np.minimum(limits[:, 3], limits[:, 2] * (1.0 + margin))
    return wider
