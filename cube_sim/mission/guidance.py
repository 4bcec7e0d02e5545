"""The target and the motion law a scenario's `guidance` block asks for."""

from __future__ import annotations

from math import inf, radians

from cube_sim.guidance.approach import Approach
from cube_sim.guidance.clocked_target import ClockedTarget
from cube_sim.guidance.law import MotionLaw, Target
from cube_sim.guidance.path import Path
from cube_sim.guidance.pursuit import Pursuit
from cube_sim.guidance.speed import StoppingSpeed
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission.path import laps_of, speed_of
from cube_sim.scenario import Scenario
from cube_sim.scenario import path_blocks as blocks


def guidance_of(scenario: Scenario, path: Path, lateral_time_s: float) -> tuple[Target, MotionLaw]:
    """Who runs along the path, and how the vehicle keeps up; a point is held whatever the law.

    Args:
        scenario: its `guidance` and `path` are read.
        path: the path.
        lateral_time_s: in which a small cross-track error shrinks by 63 % where the scenario gives no gain.
    """
    guidance, profile, laps = scenario.guidance, speed_of(scenario.guidance, path), laps_of(scenario.path)
    is_point = isinstance(scenario.path, blocks.PointBlock)
    if is_point or guidance.law == "trajectory_tracking":
        if is_point or guidance.stop_at_end:
            profile = StoppingSpeed(profile, path.length * laps, guidance.stop_time_s)
        closing_speed = guidance.speed_m_s if guidance.closing_speed_m_s is None else guidance.closing_speed_m_s
        return ClockedTarget(path, profile, laps), Pursuit(profile, guidance.tracking_time_s, closing_speed)
    limit, angle, gain = (
        guidance.target_speed_limit_m_s,
        radians(guidance.approach_angle_deg),
        guidance.approach_gain_per_m,
    )
    closing_limit = guidance.closing_speed_m_s
    if closing_limit is None:
        closing_limit = inf if gain is None else 0.0
    if gain is None:
        gain = 1.0 / (lateral_time_s * angle * profile.most)
    return (
        VirtualTarget(path, guidance.target_gain_per_s, inf if limit is None else limit, laps=laps),
        Approach(
            profile,
            angle,
            gain,
            guidance.stop_time_s if guidance.stop_at_end else None,
            closing_limit,
        ),
    )
