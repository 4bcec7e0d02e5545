"""A loaded scenario turned into the planar path-following controller."""

from __future__ import annotations

from math import inf, radians

import numpy as np

from cube_sim.control.planar.approach_angle import ApproachAngle
from cube_sim.control.planar.dynamic import DynamicLaw, Gains
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.guidance.path import Path
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission.hull import Hull
from cube_sim.mission.knowledge import believed_planar_model
from cube_sim.mission.path import is_level, laps_of, speed_of
from cube_sim.mission.planar_knowledge import planar_model
from cube_sim.scenario import Loaded
from cube_sim.scenario.path_blocks import Point


def planar_follower(loaded: Loaded, believed: Hull, path: Path) -> PlanarFollower:
    """The controller of `control.law: planar_lapierre_2007`.

    Raises:
        ScenarioError: the path is not level, the vehicle cannot stop or steer as told; with position.
    """
    scenario, (model, vehicle) = loaded.scenario, believed
    guidance, planar = scenario.guidance, scenario.control.planar
    profile = speed_of(guidance, path)
    mistakes = []
    if isinstance(scenario.path, Point):
        mistakes.append(loaded.mistake("path", "a planar law steers by moving ahead and cannot stay at a point"))
    if guidance.law == "trajectory_tracking":
        text = "a planar law follows paths, its target waits for the vehicle: give path_following"
        mistakes.append(loaded.mistake("guidance.law", text))
    stations = np.linspace(0.0, path.length, 501)
    if not is_level(path):
        mistakes.append(loaded.mistake("path", "a planar law follows level paths, this one climbs or sinks"))
    if guidance.stop_at_end and not path.closed:
        text = "a planar law steers by moving ahead and cannot stop at the end of an open path: give false"
        mistakes.append(loaded.mistake("guidance.stop_at_end", text))
    if not planar.least_speed_m_s < min(profile.at(s).value for s in stations):
        text = f"must lie below the speed wanted everywhere, got {planar.least_speed_m_s:g} m/s"
        mistakes.append(loaded.mistake("control.planar.least_speed_m_s", text))
    if np.linalg.matrix_rank(vehicle.actuation_matrix[[0, 5]]) < 2:
        text = "a planar law needs a force ahead and a torque about the vertical; these thrusters do not give both"
        mistakes.append(loaded.mistake("model", text))
    try:
        knowledge = believed_planar_model(planar_model(model, vehicle), vehicle, scenario.knowledge)
    except ModelError as error:
        mistakes.append(loaded.mistake("control.law", str(error)))
        raise ScenarioError(mistakes) from None
    if mistakes:
        raise ScenarioError(mistakes)
    limit = inf if guidance.target_speed_limit_m_s is None else guidance.target_speed_limit_m_s
    return PlanarFollower(
        target=VirtualTarget(path, guidance.target_gain_per_s, limit, laps=laps_of(scenario.path)),
        profile=profile,
        law=DynamicLaw(
            model=knowledge,
            approach=ApproachAngle(radians(guidance.approach_angle_deg), guidance.approach_gain_per_m),
            gains=Gains(
                planar.angle_gain_per_s,
                guidance.target_gain_per_s,
                planar.yaw_rate_gain_per_s,
                planar.surge_gain_per_s,
                planar.angle_stiffness_per_s2,
            ),
            least_speed=planar.least_speed_m_s,
            target_speed_limit=limit,
        ),
    )
