"""Whether there is an attitude in which a vehicle points its thrust well on a course.

A course may have trims, every small motion about them may be controllable, and yet nobody would fly it: in each of them
a small disturbance asks for a large turn. The analysis and the run say so in the same words.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.authority import Capability
from cube_sim.control.course_trim import BLUNT, EVERY, CourseTrims
from cube_sim.control.roomiest_attitude import spread_attitudes
from cube_sim.vehicle.dynamics import Dynamics

HELD = 1.0
"""Share of the steady wrench that the thrusters attain in a trim that counts."""
DISTURBANCE = 0.1
"""Share of the steady force by which it is told how far the hull has to turn."""


def badly_pointed(left: Capability, hull: Dynamics, speed_m_s: float) -> str | None:
    """Words for a level course with trims in none of which the thrust is pointed well; None where it is in one.

    None, too, of a vehicle that points no thrust, that has a thruster stuck, or whose course has no trim at all.

    Args:
        left: what the thrusters can still do.
        hull: the body.
        speed_m_s: through the water.
    """
    trims = CourseTrims.of(left, hull, speed_m_s, 0.0)
    if trims is None:
        return None
    R, found = trims.attitudes.trimmed(np.concatenate([np.eye(3)[None], spread_attitudes()[::EVERY]]))
    share, _, turn, _ = trims.qualities(R[found])
    held = share >= HELD
    sharpest = float(np.min(turn[held], initial=np.inf))
    if not np.any(held) or sharpest <= BLUNT:
        return None
    disturbance, turned = f"{100.0 * DISTURBANCE:.0f} %", np.degrees(DISTURBANCE * sharpest)
    course = f"a level course at {speed_m_s:.2g} m/s"
    points = f"{disturbance} more or less of the force it takes asks for a turn of {turned:.0f} deg"
    return f"no attitude points the thrust well on {course}: in the best, {points}"
