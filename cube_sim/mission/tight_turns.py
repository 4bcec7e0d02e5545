"""What is said beforehand of turns that a vehicle does not make by its fins in the currents of its scenario."""

from __future__ import annotations

import numpy as np

from cube_sim.control.course_keeping import CourseKeeping
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.tight_turns import tightest_turn
from cube_sim.mission import Mission
from cube_sim.mission.water import told_currents


def tight_turn_words(mission: Mission) -> str | None:
    """Words for the tightest turn of the path, where it is tighter than fins hold; None where they hold all.

    None, too, of a vehicle that another law or its thrusters steer, and where it is slower in turns.
    """
    law, guidance = mission.controller, mission.scenario.guidance
    planned = guidance.lateral_acceleration_m_s2 is not None
    if not isinstance(law, PathFollower) or not law.keeps_course or planned or mission.path.length <= 0.0:
        return None
    keeping = CourseKeeping.of(law.capability, law.loops.dynamics, law.fins_speed)
    if keeping is None:
        return None
    found = (tightest_turn(keeping, mission.path, current) for current in told_currents(mission.scenario))
    times, at, current = max(found, key=lambda turn: turn.times)
    if times <= 1.0:
        return None
    fast = float(np.linalg.norm(current))
    water = f"in a current of {fast:.2g} m/s " if fast > 0.0 else ""
    return (
        f"{water}the path turns {times:.2g} times as fast {at:.4g} m from its start as the fins hold at the flow there;"
        " it will be left"
    )
