"""The hull a scenario flies: its compiled model and its state at time 0."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np

from cube_sim.errors import ModelError, ScenarioError
from cube_sim.mission.disturbance import force_events, set_pushes
from cube_sim.mission.setpoints import commanded, require_possible_setpoints, setpoints_of
from cube_sim.mission.water import water_schedule
from cube_sim.nearest import among
from cube_sim.scenario import Loaded, Scenario
from cube_sim.spatial import quaternion_from_euler, rotation_from_quaternion
from cube_sim.vehicle.compiled_once import CompiledOnce, room
from cube_sim.vehicle.current import current_table
from cube_sim.vehicle.mjcf.numeric_names import CURRENT, SURFACE
from cube_sim.vehicle.mjcf.places import at_its_place
from cube_sim.vehicle.mjcf.time_step import require_time_step
from cube_sim.vehicle.mjcf.unused import without_thrusters
from cube_sim.vehicle.other_actuators import other_actuators
from cube_sim.vehicle.standing import as_it_stands
from cube_sim.vehicle.vehicle import Vehicle, hull_names


class CompiledHull(NamedTuple):
    """A hull and the compiled MuJoCo model it is part of."""

    model: mujoco.MjModel
    vehicle: Vehicle


def flown_hull(loaded: Loaded) -> CompiledHull:
    """The model with water and the vehicle in it that flies, as the scenario changes them.

    Raises:
        ScenarioError: the model is not right, or has no such vehicle; with position.
    """
    scenario = loaded.scenario
    given = {**surface_parameters(scenario), **scenario.parameters}
    hull, water = _hull(loaded, scenario.model, "model", given), water_schedule(scenario)
    if water is not None:
        if current_table(hull.model) is not None:
            text = "the model has a current of its own by time and height, water:current: leave one of both out"
            raise ScenarioError([loaded.mistake(_of_the_schedule(scenario), text)])
        hull = _hull(loaded, scenario.model, "model", {**given, **water_parameters(scenario)})
    require_possible_setpoints(loaded, *hull)
    hull = _as_told(hull, scenario)
    set_pushes(loaded, *hull)
    set_physics(hull.model, scenario)
    try:
        require_time_step(hull.model)
    except ModelError as error:
        raise ScenarioError([loaded.mistake("physics.step_s", f"{scenario.model}: {error}", because="model")]) from None
    return hull


def water_parameters(scenario: Scenario) -> dict[str, Sequence[float]]:
    """The current that a scenario gives to its model as a table, as a parameter of it; none where it is steady."""
    water = water_schedule(scenario)
    return {} if water is None else {CURRENT: water.rows.ravel().tolist()}


def surface_parameters(scenario: Scenario) -> dict[str, Sequence[float]]:
    """The surface that a scenario gives to its water, as a parameter of its model; none where the model decides."""
    return {} if scenario.surface_m is None else {SURFACE: [scenario.surface_m]}


def set_physics(model: mujoco.MjModel, scenario: Scenario) -> None:
    """Let a model go on as a scenario says, in its current."""
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{scenario.physics.integrator.upper()}")
    model.opt.timestep = scenario.physics.step_s
    model.opt.wind[:] = scenario.current_m_s if water_schedule(scenario) is None else 0.0
    # A state that has left the real numbers must end the run, not silently start it again.
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET


def _of_the_schedule(scenario: Scenario) -> str:
    """The key for which the current of a scenario takes a table."""
    if scenario.current_profile is not None:
        return "current_profile"
    kinds = (
        i for i, event in enumerate(scenario.events) if event.kind == "current" and (event.over_s or event.profile)
    )
    return f"events.{next(kinds)}"


def believed_hull(loaded: Loaded, flown: CompiledHull) -> CompiledHull:
    """The vehicle the controller reckons with before the factors of `knowledge`.

    Raises:
        ScenarioError: its model is not right, or has other thrusters; with position.
    """
    file = loaded.scenario.knowledge.model
    if file is None:
        return flown
    believed = _hull(loaded, file, "knowledge.model", {})
    names, there = flown.vehicle.thrusters.names, believed.vehicle.thrusters.names
    if names != there:
        text = f"has the thrusters {', '.join(there)}; the vehicle that flies has {', '.join(names)}"
        raise ScenarioError([loaded.mistake("knowledge.model", f"{file}: {text}")])
    fins, there = (() if hull.vehicle.fins is None else hull.vehicle.fins.names for hull in (flown, believed))
    if fins != there:
        text = f"has the fins {', '.join(there) or 'of none'}; the vehicle that flies has {', '.join(fins) or 'none'}"
        raise ScenarioError([loaded.mistake("knowledge.model", f"{file}: {text}")])
    known = other_actuators(*believed).keys() >= {*commanded(loaded.scenario)}
    return _as_told(believed, loaded.scenario) if known else believed


def _as_told(hull: CompiledHull, scenario: Scenario) -> CompiledHull:
    """The hull with its ballast and its joints where the scenario's set-points have them at time 0."""
    setpoints = setpoints_of(scenario, *hull)
    if setpoints is None:
        return hull
    data = mujoco.MjData(hull.model)
    setpoints.begin(hull.model, data)
    return CompiledHull(hull.model, as_it_stands(hull.model, hull.vehicle.name, data))


def _hull(loaded: Loaded, file: str, key: str, parameters: Mapping[str, Sequence[float]]) -> CompiledHull:
    """The model of a file with parameters; flights that share what they can compile it once, whatever their numbers."""
    shared = loaded.shared
    if shared is None:
        once, vehicle = _compiled(loaded, file, key, parameters)
        return CompiledHull(once.model, vehicle)
    scenario = loaded.scenario
    of_thrusters = tuple(scenario.thrusters.model_dump(exclude_none=True))
    asked = file, room(parameters), scenario.vehicle, of_thrusters, len(force_events(scenario))
    once, vehicle = shared.get(asked, lambda: _compiled(loaded, file, key, parameters))
    given = {**parameters, **thruster_parameters(scenario, vehicle)}
    model = once.with_parameters(given)  # a flight changes its model
    if model is None:
        once, vehicle = _compiled(loaded, file, key, parameters)
        return CompiledHull(once.model, vehicle)
    return CompiledHull(model, vehicle if once.has(given) else Vehicle.from_model(model, vehicle.name))


def _compiled(
    loaded: Loaded, file: str, key: str, parameters: Mapping[str, Sequence[float]]
) -> tuple[CompiledOnce, Vehicle]:
    scenario = loaded.scenario
    pushes = len(force_events(scenario))
    try:
        once = CompiledOnce.of(file, parameters, pushes)
        vehicle = _chosen_hull(loaded, once.model, key)
        of_thrusters = thruster_parameters(scenario, vehicle)
        if of_thrusters:
            once = CompiledOnce.of(file, {**parameters, **of_thrusters}, pushes)
            vehicle = Vehicle.from_model(once.model, vehicle.name)
    except ModelError as error:
        where = key
        if scenario.thrusters.dead_zone_N is not None and error.element.endswith("thruster_dead_zone"):
            where = "thrusters.dead_zone_N"
        elif error.element in parameters:
            where = "parameters"
        told = str(error) if where == "parameters" else str(at_its_place(error, Path(file)))
        raise ScenarioError([loaded.mistake(where, told)]) from None
    if not vehicle.thrusters.names:
        where = key if scenario.vehicle is None else "vehicle"
        raise ScenarioError([loaded.mistake(where, f"{file}: {without_thrusters(once.model, vehicle.name)}")])
    return once, vehicle


def thruster_parameters(scenario: Scenario, vehicle: Vehicle) -> dict[str, Sequence[float]]:
    """What a scenario's `thrusters` block says of each, as parameters of its model."""
    zone, given = scenario.thrusters.dead_zone_N, {}
    if zone is not None:
        # Every thruster gets it, whether the model states dead zones per hull or per thruster.
        given |= {f"{owner}:thruster_dead_zone": zone for owner in (vehicle.name, *vehicle.thrusters.names)}
    return given


def _chosen_hull(loaded: Loaded, model: mujoco.MjModel, key: str) -> Vehicle:
    hulls, name = hull_names(model), loaded.scenario.vehicle
    if name is None and len(hulls) > 1:
        text = f"the model has several hulls: {', '.join(hulls)}; say which one flies, for example vehicle: {hulls[0]}"
        raise ScenarioError([loaded.mistake(key, text)])
    if name is not None and name not in hulls:
        raise ScenarioError([loaded.mistake("vehicle", f"no hull '{name}'; the model has {among(name, hulls)}")])
    return Vehicle.from_model(model, name)


def initial_state(model: mujoco.MjModel, vehicle: Vehicle, scenario: Scenario) -> mujoco.MjData:
    """MuJoCo's data at the scenario's initial condition."""
    data = mujoco.MjData(model)
    put_initial(model, data, vehicle, scenario)
    return data


def put_initial(model: mujoco.MjModel, data: mujoco.MjData, vehicle: Vehicle, scenario: Scenario) -> None:
    """Put a vehicle into its scenario's initial condition."""
    initial = scenario.initial
    q = quaternion_from_euler(*np.radians(initial.attitude_deg))
    at, dof = vehicle.qpos_address, vehicle.dof_address
    data.qpos[at : at + 3] = initial.position_m
    data.qpos[at + 3 : at + 7] = q
    data.qvel[dof : dof + 3] = rotation_from_quaternion(q) @ np.array(initial.velocity_m_s)
    data.qvel[dof + 3 : dof + 6] = np.radians(initial.rates_deg_s)
    if (setpoints := setpoints_of(scenario, model, vehicle)) is not None:
        setpoints.begin(model, data)
