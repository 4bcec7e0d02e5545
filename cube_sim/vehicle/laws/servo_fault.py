"""Faults of a fin's servo: where it turns to and how fast, and a fin that has come loose of it.

A jammed servo goes to an angle at its own rate and stays there, or stays where it is. A slow one has a lower rate, one
short of travel stops earlier. A fin that has come loose follows the flow like a vane, with the lag of its servo: its
angle of attack dies out, and its lift with it; what drag it has is left.
"""

from __future__ import annotations

from math import atan2, inf, pi

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, dot, plus
from cube_sim.vehicle.laws.fin import CHORD, NORMAL, PLACE, STALL, servo_rate

ACTUATOR, FIN, TARGET, FASTEST, LEAST, MOST, LOOSE = 0, 1, 2, 3, 4, 5, 6
"""Columns of a table of servos, a row each.

The actuator; the number of its fin among all fins; the angle that it goes to whatever it is told [rad], NaN for one
that does what it is told; the fastest rate it has left [rad/s], infinite for its own; least and largest deflection it
has left [rad], infinite for its own; 1 for a fin that has come loose.
"""
COLUMNS = 7
WHOLE = (float("nan"), inf, -inf, inf, 0.0)
"""The columns from `TARGET` on of a servo without a fault."""


@compiled
def faulty_rate(row, target, deflection, lag_s, limit):
    """How fast a servo turns its fin [rad/s], its faults counted in.

    Args:
        row: (`COLUMNS`,) of the table.
        target: it is told [rad], within its own travel.
        deflection: [rad].
        lag_s: time constant [s].
        limit: its own fastest rate [rad/s].
    """
    target = min(max(target, row[LEAST]), row[MOST])
    if row[TARGET] == row[TARGET]:
        target = row[TARGET]
    return servo_rate(target, deflection, lag_s, min(limit, row[FASTEST]))


@compiled
def loose_rate(fin, deflection, lag_s, nu_r):
    """How fast a fin that has come loose turns into the flow [rad/s].

    Args:
        fin: (16,) row of the table of `cube_sim.vehicle.laws.fin`.
        deflection: [rad].
        lag_s: time constant [s].
        nu_r: velocity of the hull through the water, a 6-tuple, body axes [m/s, rad/s].
    """
    flow = plus(nu_r[:3], cross_tuples(nu_r[3:], (fin[PLACE], fin[PLACE + 1], fin[PLACE + 2])))
    along = dot((fin[CHORD], fin[CHORD + 1], fin[CHORD + 2]), flow)
    across = dot((fin[NORMAL], fin[NORMAL + 1], fin[NORMAL + 2]), flow)
    if along == 0.0 and across == 0.0:
        return 0.0
    vane = atan2(across, along)
    if fin[STALL] == inf:  # the linear form has no lift at across / along
        vane = min(max(across / along, -0.5 * pi), 0.5 * pi) if along != 0.0 else deflection
    return (vane - deflection) / lag_s
