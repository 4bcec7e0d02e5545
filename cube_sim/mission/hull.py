"""The hull a scenario flies: its compiled model and its state at time 0."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.errors import ModelError, ScenarioError
from cube_sim.scenario import Loaded, Scenario
from cube_sim.spatial import quaternion_from_euler, rotation_from_quaternion
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.vehicle import Vehicle, hull_names


def hull_of(loaded: Loaded) -> tuple[mujoco.MjModel, Vehicle]:
    """The model with water and the vehicle in it that flies, as the scenario changes them.

    Raises:
        ScenarioError: the model is not right, or has no such vehicle; with position.
    """
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


def initial_state(model: mujoco.MjModel, vehicle: Vehicle, scenario: Scenario) -> mujoco.MjData:
    """MuJoCo's data at the scenario's initial condition."""
    data = mujoco.MjData(model)
    initial = scenario.initial
    q = quaternion_from_euler(*np.radians(initial.attitude_deg))
    at, dof = vehicle.qpos_address, vehicle.dof_address
    data.qpos[at : at + 3] = initial.position_m
    data.qpos[at + 3 : at + 7] = q
    data.qvel[dof : dof + 3] = rotation_from_quaternion(q) @ np.array(initial.velocity_m_s)
    data.qvel[dof + 3 : dof + 6] = np.radians(initial.rates_deg_s)
    return data
