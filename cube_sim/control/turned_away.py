"""Whether a hull that its fins steer has been turned away by its flow, so that thrust would only keep it turning.

Fins that have stalled do not stop a turn. The torque that turns the hull and theirs both grow with the square of the
speed: such a hull goes round for ever at any thrust. Without thrust it loses its way in some seconds, its rates with
it, and begins anew from near rest, where thrust makes the flow come from ahead.
"""

from __future__ import annotations

from math import tan

from cube_sim.control.course_keeping import STEEPEST_FLOW_RAD
from cube_sim.native.compiled import compiled

STALLED = tan(STEEPEST_FLOW_RAD[1])
"""Slope of the flow that meets fins astern beyond which they have stalled."""
STOPPED = 0.4
"""It turns away until its rate is down to this share of the largest that it is asked for (a choice)."""


@compiled
def turns_away(course, flow, rates, wanted, share, attitude_time, dt):
    """One tick: whether the hull is to lose its way, which begins once it has turned away for the time of its attitude.

    It turns away where it turns faster than it is asked to at most, and the flow at the stern, that of the turn and of
    the slip together, is steeper than fins bear. A hull that they still stop does so within that time.

    Args:
        course: record of `cube_sim.control.course_keeping.COURSE`, moved on.
        flow: velocity through the water, a 3-tuple [m/s], body axes.
        rates: 3-tuple [rad/s], body axes.
        wanted: rates asked for, a 3-tuple [rad/s].
        share: of the speed through the water in that of the path.
        attitude_time: of the attitude's loop [s].
        dt: [s].
    """
    c = course[0]
    steep = STALLED * max(flow[0], 0.0)
    about_y, about_z = flow[2] + c.levers[0] * rates[1], c.levers[1] * rates[2] - flow[1]
    away_y, away_z = rates[1] * about_y > 0.0, rates[2] * about_z > 0.0
    most_y, most_z = c.most_rate[0], c.most_rate[1]
    fast_y = abs(rates[1]) > share * most_y and rates[1] * (rates[1] - wanted[1]) > 0.0
    fast_z = abs(rates[2]) > share * most_z and rates[2] * (rates[2] - wanted[2]) > 0.0
    begins = (away_y and fast_y and abs(about_y) > steep) or (away_z and fast_z and abs(about_z) > steep)
    goes_on = (away_y and abs(rates[1]) > STOPPED * most_y) or (away_z and abs(rates[2]) > STOPPED * most_z)
    c.turned_for = c.turned_for + dt if begins and not c.turned_away else 0.0
    c.turned_away = goes_on and (c.turned_away or c.turned_for > attitude_time)
    return c.turned_away
