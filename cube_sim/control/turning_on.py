"""An attitude that is led from tick to tick: what it answers, and how it goes on."""

from __future__ import annotations

from cube_sim.native.compiled import compiled
from cube_sim.tuples import length, put_matrix, quaternion_from_matrix, rotated, times, to_world


@compiled
def tell_attitude(answer, R, rates_W):
    """Fill a record `cube_sim.control.attitude_mode.DESIRED`: R (3,3), and its rates, a 3-tuple [rad/s], world axes."""
    out, q = answer[0], quaternion_from_matrix(R)
    out.quaternion[0] = q[0]
    for i in range(3):
        out.quaternion[1 + i], out.rates[i] = q[1 + i], rates_W[i]


@compiled
def turn_on(rotation, answer, rates, most_rate, dt):
    """Answer an attitude, and turn it for the next tick.

    Args:
        rotation: the attitude (3,3), moved on.
        answer: of `tell_attitude`.
        rates: how it is to turn, a 3-tuple [rad/s], its own axes; slowed to the most.
        most_rate: [rad/s].
        dt: [s].
    """
    speed = length(rates)
    if speed > most_rate:
        rates, speed = times(most_rate / speed, rates), most_rate
    tell_attitude(answer, rotation, to_world(rotation, rates))
    if speed > 0.0:
        put_matrix(rotation, rotated(rotation, times(1.0 / speed, rates), speed * dt))
