"""An attitude that keeps a body axis on a fixed point of the world."""

from __future__ import annotations

from math import atan2, pi

import numpy as np

from cube_sim.control.attitude_mode import DESIRED, DesiredAttitude, Situation
from cube_sim.control.levelling import levelling_spin
from cube_sim.control.turning_on import tell_attitude
from cube_sim.guidance.view_record import record_of
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, Vector, cross
from cube_sim.tuples import (
    cross_tuples,
    dot,
    length,
    minus,
    plus,
    put_matrix,
    rotated,
    times,
    to_body,
    to_world,
    triple,
)

MAX_RATE = 1.0
"""Bound on each of the two turns of the desired attitude [rad/s]."""

LOOK = np.dtype(
    [
        ("point", np.float64, 3),
        ("axis", np.float64, 3),
        ("side", np.float64, 3),
        ("near", np.float64),
        ("time", np.float64),
        ("levelling_time", np.float64),
    ]
)
"""Numbers of `LookAt`, whose arguments these are; side is the body axis (3,) that is to be level."""
MEMORY = np.dtype([("rotation", np.float64, (3, 3)), ("started", np.bool_)])
"""The desired attitude R_WD, and whether there is one yet."""


class LookAt:
    """Two tasks by priority (Nakamura 1987) on the angular velocity w of the desired attitude, world axes.

    First, the axis u = R a comes onto the line of sight l and stays there. As u' = w x u, J1 = -S(u) and J1# = S(u);
    w_1 = l x l' + psi n / T less its part along u, where psi n is the shortest turn from u to l. Second, in the null
    space of the first, I - J1# J1 = u u', the vehicle rolls level about u, as along a path.

    The angle psi decays with the time constant T, whichever way the vehicle faced. The direction of the point means
    little near the point: there w_1 is faded out, to nothing at the point itself. Straight above and below it the roll
    is left alone.

    Args:
        point: (3,) [m], world axes.
        axis: a (3,), unit, body axes.
        near: distance of the point within which w_1 is faded out [m].
        time: T [s].
        levelling_time: of the second task [s].
    """

    def __init__(self, point: Vector, axis: Vector, near: float, time: float, levelling_time: float = 2.0) -> None:
        side = cross(np.array([0.0, 0.0, 1.0]), axis)  # level and to the left of someone who looks along the axis
        size = float(np.linalg.norm(side))
        self.parameters: Record = np.zeros(1, LOOK)
        self.parameters["point"], self.parameters["axis"] = point, axis
        self.parameters["side"] = side / size if size > 1e-6 else (0.0, 1.0, 0.0)
        self.parameters["near"], self.parameters["time"] = near, time
        self.parameters["levelling_time"] = levelling_time
        self.memory: Record = np.zeros(1, MEMORY)

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The desired attitude, from the vehicle's own at the first call on, and how it turns."""
        desired = np.zeros(1, DESIRED)
        look_at(self.parameters, self.memory, desired, record_of(situation.view), situation.rotation, dt)
        return DesiredAttitude(*desired[0])


@compiled
def look_at(parameters, memory, answer, view, R_now, dt):
    """One tick of the law.

    Args:
        parameters: record `LOOK`.
        memory: record `MEMORY`, moved on.
        answer: record of `cube_sim.control.attitude_mode.DESIRED`, filled.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        R_now: R_WB (3,3) of the hull, where the desired attitude begins.
        dt: [s].
    """
    p, m = parameters[0], memory[0]
    if not m.started:
        m.started = True
        put_matrix(m.rotation, R_now)
    R, axis = m.rotation, triple(p.axis)
    u, side = to_world(R, axis), to_world(R, triple(p.side))
    first = _towards_the_point(p, u, side, view)
    spin = levelling_spin(u, cross_tuples(first, u), side, p.levelling_time)
    spin = min(max(spin, -MAX_RATE), MAX_RATE)
    tell_attitude(answer, R, plus(first, times(spin, u)))
    rolled = rotated(R, axis, spin * dt)  # first, as it leaves u where it is: the tasks do not mix in a tick
    size = length(first)
    if size > 0.0:
        put_matrix(m.rotation, rotated(rolled, to_body(rolled, times(1.0 / size, first)), size * dt))
    else:
        put_matrix(m.rotation, rolled)


@compiled
def _towards_the_point(p, u, side, view):
    """w_1, a 3-tuple [rad/s], world axes, bounded."""
    seen = view[0]
    here = plus((seen.row[0], seen.row[1], seen.row[2]), to_world(seen.frame, triple(seen.error)))
    sight = minus(triple(p.point), here)
    velocity = to_world(seen.frame, triple(seen.velocity))
    distance = length(sight)
    if not distance > 1e-6 * p.near:
        return (0.0, 0.0, 0.0)
    line = times(1.0 / distance, sight)
    turning = times(1.0 / distance, cross_tuples(velocity, line))  # l x l' with l' = -(v - l l' v) / distance
    w = plus(turning, times(1.0 / p.time, shortest_turn(u, line, side)))
    near = min(1.0, distance / p.near)
    w = times(near * near * (3.0 - 2.0 * near), minus(w, times(dot(u, w), u)))
    size = length(w)
    return w if size <= MAX_RATE else times(MAX_RATE / size, w)


@compiled
def shortest_turn(a, b, axis_if_opposite):
    """Rotation vector, a 3-tuple [rad], that takes one unit vector to another; all 3-tuples."""
    normal = cross_tuples(a, b)
    sine, cosine = length(normal), dot(a, b)
    if sine > 1e-9:
        return times(atan2(sine, cosine) / sine, normal)
    return times(pi if cosine < 0.0 else 0.0, axis_if_opposite)
