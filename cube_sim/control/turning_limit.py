"""How tight the turns are that a vehicle keeps: the judgement that the analysis and the run share."""

from __future__ import annotations

import numpy as np

from cube_sim.actuation.path_following.steady_turn import TIGHTEST_M, TurningTrim, turning_trim
from cube_sim.actuation.path_following.trim import CourseAttitudes, TrimCondition
from cube_sim.control.authority import Capability
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import PLANAR, SPATIAL

IN_PLANE = list(PLANAR.rows)
SLOWER = 0.5
"""Where the thrusters do not keep the speed in a turn the vehicle waits for them: turns count that it keeps at this
share of its speed (a choice)."""


def turning_of(
    left: Capability,
    hull: Dynamics,
    speed_m_s: float,
    known: TrimCondition | None = None,
    radius_m: float = TIGHTEST_M,
    nose_ahead: bool = False,
) -> TurningTrim | None:
    """The trim in which it turns as tightly as asked, or as tightly as it can, with what its demands are projected on.

    Args:
        left: what the thrusters can still do.
        hull: the body.
        speed_m_s: along the path, positive.
        known: a trim of a level course.
        radius_m: of the turns asked for.
        nose_ahead: whether no other attitude counts, as of a hull that its fins steer.

    Returns:
        None where a level course has no trim within the limits, and of a vehicle in a level plane that has all it needs
        there.
    """
    rows = IN_PLANE if left.level else list(SPATIAL.rows)
    lost = left.lost[rows]
    lost = lost[:, np.any(lost != 0.0, axis=0)]
    straight = CourseAttitudes.without(hull, lost, tuple(rows), speed_m_s)
    attainable = None if left.budget is None or left.level else left.budget.attainable
    return turning_trim(straight, attainable, known, radius_m, nose_ahead or left.by_flow)


def too_tight(left: Capability, hull: Dynamics, speed_m_s: float, radius_m: float) -> str | None:
    """Words for turns that a vehicle which has to point or lean its thrust does not keep; None for those it does.

    Args:
        left: what the thrusters can still do.
        hull: the body.
        speed_m_s: along the path.
        radius_m: of the tightest turn of the path; infinite where it is straight.
    """
    if not (left.steers_by_attitude and speed_m_s > 0.0 and np.isfinite(radius_m)) or np.any(left.held):
        return None
    asked, widest = max(radius_m, TIGHTEST_M), np.inf
    for speed in (speed_m_s, SLOWER * speed_m_s):
        found = turning_of(left, hull, speed, radius_m=asked)
        widest = widest if found is None else min(widest, found.radius_m)
        if widest <= asked:
            return None
    kept = "straight courses" if np.isinf(widest) else f"turns of {widest:.2g} m"
    return f"the path turns within {radius_m:.2g} m, and at {speed_m_s:g} m/s the thrusters keep {kept} only"
