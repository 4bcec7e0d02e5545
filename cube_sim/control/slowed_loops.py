"""The loops and the approach of what is left of a vehicle: no faster than its way of flying bears."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from cube_sim.control.authority import POINTING, Capability
from cube_sim.control.closing import closing_speed
from cube_sim.control.course_keeping import CourseKeeping
from cube_sim.control.course_trim import SLOWER, CourseTrims, level_motion
from cube_sim.control.loops import MotionLoops
from cube_sim.control.pointing_zero import most_turning, zero_time
from cube_sim.guidance.approach import Approach
from cube_sim.guidance.law import MotionLaw

SLOWER_ACROSS = 2.0
"""The cross-track error is then removed this many times more slowly than that of the velocity."""
MOST_WAITING = 4.0
"""The loop whose attitude points the thrust is made no slower than this many times its time (a choice)."""
ROOM_TO_TURN = 2.0
"""A hull that is to turn slowly may turn this many times as fast as the path does in its tightest turn (a choice)."""


def slowed_loops(
    left: Capability, loops: MotionLoops, approach: MotionLaw, pointing_time: float, radius: float, trims_at: float
) -> tuple[MotionLoops, MotionLaw]:
    """Loops and approach of a hull that nothing but its thrusters steer.

    Where the attitude points the thrust, force across the line has to wait for it: the velocity loop must be the slower
    one. Elsewhere the approach closes no faster than the thrusters afford.

    Args:
        left: what the thrusters can do.
        loops: of the vehicle as built.
        approach: likewise.
        pointing_time: of the attitude's loop, where it points the thrust [s].
        radius: of the tightest turn of the path [m]; infinite where it has none.
        trims_at: speed for whose trims that time is found, where turning pushes the hull [m/s]; 0 leaves it as it is.
    """
    hull = loops.dynamics
    if left.authority not in POINTING:
        if not isinstance(approach, Approach):
            return loops, approach
        return loops, approach.at_closing_speed(closing_speed(left, hull, approach.lateral_time))
    pointing = _pointing_time(left, loops, pointing_time, radius, trims_at)
    slower, turn = max(loops.velocity_time, SLOWER * pointing), loops.most_rate
    if isinstance(approach, Approach):
        level = level_motion(left, hull, approach.most_speed, pointing_time, radius)
        if level is not None:
            slower = max(slower, zero_time(left, hull, *level))
            room = ROOM_TO_TURN * approach.most_speed / radius
            turn = max(most_turning(left, hull, *level, slower, turn), min(turn, room))
        approach = approach.no_faster_than(SLOWER_ACROSS * slower)
    return replace(loops, velocity_time=slower, attitude_time=pointing, most_rate=turn), approach


def slowed_approach(approach: MotionLaw, keeping: CourseKeeping, attitude_time: float) -> MotionLaw:
    """The approach of a hull that its fins steer, behind an attitude's loop of a time [s]."""
    if not isinstance(approach, Approach):
        return approach
    return approach.no_faster_than(keeping.lateral_time(attitude_time))


def _pointing_time(left: Capability, loops: MotionLoops, time: float, radius: float, speed: float) -> float:
    """How fast the attitude points the thrust [s]: where turning pushes the hull in another trim, no faster."""
    if not (speed > 0.0 and radius < inf):
        return time
    trims = CourseTrims.of(left, loops.dynamics, speed, 0.0, time)
    slowest = None if trims is None else trims.slowest_elsewhere_rad_s(np.eye(3), radius)
    wanted = 0.0 if slowest is None else 1.0 / slowest
    return min(max(time, wanted), MOST_WAITING * time)
