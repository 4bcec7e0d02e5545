"""A loaded scenario turned into the planar path-following controller."""

from __future__ import annotations

from math import inf, radians, sqrt

import numpy as np

from cube_sim.control.moment_budget import NOTHING_MOVES
from cube_sim.control.planar.approach_angle import ApproachAngle
from cube_sim.control.planar.attainable_set import PlanarAttainableSet
from cube_sim.control.planar.dynamic import DynamicLaw, Gains
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.guidance.path import Path
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission.hull import CompiledHull
from cube_sim.mission.knowledge import believed_planar_model
from cube_sim.mission.moment import limits_move
from cube_sim.mission.path import is_level, laps_of, speed_of
from cube_sim.mission.planar_identification import identify_planar_model
from cube_sim.mission.planar_speed import flyable_speed
from cube_sim.mission.planar_water import planar_observer
from cube_sim.mission.refusals import too_slow_period, wrong_depth
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.path_blocks import PointBlock
from cube_sim.scenario.schema import ControlBlock, SafeModeBlock

UNUSED = (
    "velocity_time_s",
    "attitude_time_s",
    "rate_time_s",
    "cost_limit",
    "attitude",
    "priority",
)
"""Keys of `control` which only the law for all axes knows."""
APPROACH_GAIN = 0.5
"""k_delta [1/m] where the scenario does not say."""


def planar_follower(loaded: Loaded, believed: CompiledHull, path: Path) -> PlanarFollower:
    """The controller of `control.law: planar_lapierre_2007`.

    Raises:
        ScenarioError: the path is not level, the vehicle cannot stop or steer as the scenario asks; with position.
    """
    scenario, (model, vehicle) = loaded.scenario, believed
    guidance, planar = scenario.guidance, scenario.control.planar
    profile = speed_of(guidance, path)
    mistakes = _without_effect(loaded) + too_slow_period(loaded, _loop_times(scenario))
    if isinstance(scenario.path, PointBlock):
        mistakes.append(loaded.mistake("path", "a planar law steers by moving ahead and cannot stay at a point"))
    if guidance.law != "path_following":
        text = "a planar law follows paths, its target waits for the vehicle: give path_following"
        mistakes.append(loaded.mistake("guidance.law", text))
    if not is_level(path):
        mistakes.append(loaded.mistake("path", "a planar law follows level paths, this one climbs or sinks"))
    mistakes += wrong_depth(loaded, path)
    if guidance.stop_at_end and laps_of(scenario.path) < inf:
        text = "a planar law steers by moving ahead and cannot stop where the path or its last lap ends: give false"
        mistakes.append(loaded.mistake("guidance.stop_at_end", text, because="path"))
    if not planar.least_speed_m_s < profile.least:
        text = f"must lie below the speed wanted everywhere, got {planar.least_speed_m_s:g} m/s"
        mistakes.append(loaded.mistake("control.planar.least_speed_m_s", text, because="guidance.speed_m_s"))
    if np.linalg.matrix_rank(vehicle.actuation_matrix[[0, 5]]) < 2:
        text = "a planar law needs a force ahead and a torque about the vertical; these thrusters do not give both"
        mistakes.append(loaded.mistake("model", text))
    try:
        knowledge = believed_planar_model(identify_planar_model(model, vehicle), vehicle, scenario.knowledge)
    except ModelError as error:
        mistakes.append(loaded.mistake("control.law", str(error), because="model"))
        raise ScenarioError(mistakes) from None
    if mistakes:
        raise ScenarioError(mistakes)
    ends = vehicle.thrusters.limits[:, [0, 3]]
    attainable = PlanarAttainableSet.of(vehicle.actuation_matrix, ends)
    moves = limits_move(vehicle.thrusters, model, scenario.battery is not None)
    profile = flyable_speed(profile, guidance, path, knowledge, attainable)
    limit = inf if guidance.target_speed_limit_m_s is None else guidance.target_speed_limit_m_s
    return PlanarFollower(
        target=VirtualTarget(path, guidance.target_gain_per_s, limit, laps=laps_of(scenario.path)),
        profile=profile,
        law=DynamicLaw(
            model=knowledge,
            approach=ApproachAngle(
                radians(guidance.approach_angle_deg),
                APPROACH_GAIN if guidance.approach_gain_per_m is None else guidance.approach_gain_per_m,
            ),
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
        observer=planar_observer(scenario, knowledge, profile.least),
        attainable=attainable,
        waits=guidance.wait_for_thrusters,
        moment=attainable.moving(vehicle.actuation_matrix, ends) if moves else NOTHING_MOVES,
    )


def _without_effect(loaded: Loaded) -> list[str]:
    """Mistakes: values that differ from their defaults, though the planar law has no use for them."""
    control, default = loaded.scenario.control, ControlBlock()
    text = "the planar law has no use for it, and what it says would not happen: leave it out"
    return [
        loaded.mistake(f"control.{key}", text) for key in UNUSED if getattr(control, key) != getattr(default, key)
    ] + [
        loaded.mistake(f"control.safe_mode.{key}", text)
        for key in SafeModeBlock.model_fields
        if getattr(control.safe_mode, key) != getattr(default.safe_mode, key)
    ]


def _loop_times(scenario: Scenario) -> dict[str, float]:
    """How fast each loop of the planar law is, by the value that says so [s]."""
    planar = scenario.control.planar
    return {
        "guidance.target_gain_per_s": 1.0 / scenario.guidance.target_gain_per_s,
        "control.planar.angle_gain_per_s": 1.0 / planar.angle_gain_per_s,
        "control.planar.yaw_rate_gain_per_s": 1.0 / planar.yaw_rate_gain_per_s,
        "control.planar.surge_gain_per_s": 1.0 / planar.surge_gain_per_s,
        "control.planar.angle_stiffness_per_s2": 1.0 / sqrt(planar.angle_stiffness_per_s2),
    }
