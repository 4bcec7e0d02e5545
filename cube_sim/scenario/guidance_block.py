"""The `guidance` block: how the target moves along the path, and how the vehicle closes in on it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from cube_sim.scenario.python_block import NAME, NAMED_OR_OWN, OwnPython
from cube_sim.scenario.values import Acceleration, Block, Rate, Seconds, Speed

GuidanceName = Literal["path_following", "trajectory_tracking"]
AnyGuidance = Annotated[Annotated[GuidanceName, NAME] | OwnPython, NAMED_OR_OWN]


class GuidanceBlock(Block):
    """How the target moves along the path and how the vehicle closes in on it."""

    law: AnyGuidance = Field(
        default="path_following",
        description="path_following: the target waits for the vehicle. trajectory_tracking: it runs by the clock from"
        " time 0, at the speed along the path. A path of type point is held under either law. Code of your own says"
        " with which velocity a vehicle comes to a target that waits for it.",
    )
    speed_m_s: Speed = Field(description="Speed along the path [m/s].")
    lateral_acceleration_m_s2: Acceleration | None = Field(
        default=None,
        description="Slow down in curves so that speed^2 / radius stays below this [m/s^2]. Default: one speed.",
    )
    along_acceleration_m_s2: Acceleration = Field(
        default=0.05, description="How fast the speed may change before and after a curve [m/s^2]."
    )
    tracking_time_s: Seconds = Field(
        default=2.0, description="Tracking, or at a point: time that removes 63 % of a small position error [s]."
    )
    closing_speed_m_s: Speed | None = Field(
        default=None,
        description="How fast a large position error is run down at most [m/s]. Tracking, or at a point: beside the"
        " target's own speed, default: speed_m_s. Path following by the law for all axes: across the path, where the"
        " thrusters afford more than speed_m_s; default: what they afford, or with approach_gain_per_m no more than"
        " the speed along the path.",
    )
    approach_angle_deg: float = Field(
        default=60.0,
        gt=0,
        lt=90,
        description="Angle to the path at which the vehicle approaches from far away [deg].",
    )
    approach_gain_per_m: Rate | None = Field(
        default=None,
        description="k_delta in theta = approach angle * tanh(k_delta * cross-track error) [1/m]. Default: 0.5 for the"
        " planar law; for all axes, what removes a small error in four times control.velocity_time_s.",
    )
    target_gain_per_s: Rate = Field(
        default=0.5,
        description="k_2 in s' = v_T + k_2 s_1: how fast the target closes its along-track gap [1/s].",
    )
    target_speed_limit_m_s: Speed | None = Field(
        default=None, description="Bound on |s'|, the virtual target's speed [m/s]. Default: none."
    )
    wait_for_thrusters: bool = Field(
        default=True,
        description="Whether the speed along the path falls to what the thrusters can keep where they cannot make all"
        " that is asked (path_following; the planar law: while it is short of torque). false: the path is cut instead.",
    )
    stop_at_end: bool = Field(
        default=True, description="Whether to come to rest at the end, or run on along the last tangent."
    )
    stop_time_s: Seconds = Field(
        default=2.0,
        description="The speed falls as remaining path / stop_time_s before the end of the path [s]; in a longer time "
        "where the attitude has to point the thrust.",
    )
