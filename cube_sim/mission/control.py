"""The controller a scenario asks for."""

from __future__ import annotations

from math import inf, radians

import numpy as np

from cube_sim.control.attitude import AlongPath, AttitudeMode, FixedAttitude
from cube_sim.control.authority import Authority, capability
from cube_sim.control.controller import Controller
from cube_sim.control.current import CurrentObserver
from cube_sim.control.diagnosis import Diagnosis
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.control.loops import MotionLoops
from cube_sim.control.path_follower import PathFollower
from cube_sim.errors import ScenarioError
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.path import Path
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission.hull import Hull
from cube_sim.mission.knowledge import believed_dynamics
from cube_sim.mission.path import is_level, laps_of, speed_of
from cube_sim.mission.planar import planar_follower
from cube_sim.scenario import Loaded, Scenario, schema
from cube_sim.spatial import quaternion_from_euler
from cube_sim.vehicle.vehicle import Vehicle


def controller_of(loaded: Loaded, believed: Hull, path: Path) -> Controller:
    """The law from states to wrenches, for the vehicle the controller believes to fly.

    Raises:
        ScenarioError: the law does not fit the path or the vehicle; with position.
    """
    scenario = loaded.scenario
    guidance, control = scenario.guidance, scenario.control
    dynamics = believed_dynamics(believed.vehicle.dynamics, scenario.knowledge)
    if control.law == "planar_lapierre_2007":
        return planar_follower(loaded, believed, path)
    limit = guidance.target_speed_limit_m_s
    time, flow = control.disturbance_time_s, control.current_time_s
    whole = capability(believed.vehicle.actuation_matrix)
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
        current_observer=None if flow is None or time is None else CurrentObserver(dynamics, flow),
        capability=whole if whole.authority is Authority.LEVEL else capability(np.eye(6)),
    )


def _attitude(block: schema.Attitude) -> AttitudeMode:
    match block:
        case schema.AlongPath():
            return AlongPath()
        case schema.FixedAttitude():
            return FixedAttitude(quaternion_from_euler(*np.radians(block.attitude_deg)))


def diagnosis_of(vehicle: Vehicle, scenario: Scenario) -> Diagnosis:
    """Half a second of evidence, and differences beyond the dead zone, where no motor's force is certain."""
    thrusters = vehicle.thrusters
    threshold = max(0.5, 1.2 * float(np.abs(thrusters.limits[:, 1:3]).max()))
    return Diagnosis(thrusters.lag_s, 0.5, threshold, scenario.control_period_s)
