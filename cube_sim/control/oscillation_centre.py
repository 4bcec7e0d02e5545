"""The centre of oscillation of a hull that turns by a force on a lever, compiled.

Where a torque comes with a force, a hull that begins to turn is first pushed the wrong way, as a torpedo with fins at
its stern is. Answering that, by its velocity, its place or its way of approach, would feed on itself. One point is not
moved by the push: the centre of oscillation. It is the point to bring onto the path.
"""

from __future__ import annotations

from math import cos, inf, sin

import numpy as np

from cube_sim.control.levelling import levelling_spin
from cube_sim.guidance.view_record import path_turning
from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, dot, length, minus, plus, times, to_body, to_world, triple, turn_between

FORGETTING = 2.0
"""How many times the time of the velocity loop it takes to forget how far turning has pushed the hull: as long as the
cross-track error of a hull that points its thrust takes to go. Longer, a hull that leans into each curve stays beside
its path by as much as it has been pushed; shorter, the push is answered after all."""

SMALL_TURN_RAD = 1e-4
"""Below this angle the push of a turn is that of its first moment, off by half the angle."""

CENTRE = np.dtype(
    [("shift", np.float64, 3), ("pushed", np.float64, 3), ("leaving", np.float64, 3), ("started", np.bool_)]
)
"""How far the hull is off because it has turned [m]; the velocity with which turning pushes it [m/s]; that less what is
forgotten of the shift; world axes. And whether the shift has a beginning."""


@compiled
def levelled_turning(frame, turning):
    """How a hull turns (3-tuple) [rad/s], world axes, that keeps its attitude to the path and to the vertical.

    Args:
        frame: R_WF (3,3) of the path at the target.
        turning: of that frame (3-tuple) [rad/s], world axes.
    """
    T = (frame[0, 0], frame[1, 0], frame[2, 0])
    spin = levelling_spin(T, cross_tuples(turning, T), cross_tuples((0.0, 0.0, 1.0), T), inf)
    return plus(turning, times(spin, T))


@compiled
def watch_centre(left, memory, R, w, view, dt, velocity_time):
    """Move on what is known of the centre of oscillation.

    Turning with the path is no push: the hull keeps its attitude to it. The shift of a hull that no longer turns is
    forgotten, as that is where it stays.

    Args:
        left: record of `cube_sim.control.authority.CAPABILITY`.
        memory: record `CENTRE`, moved on.
        R: R_WB (3,3).
        w: (3,) [rad/s], body axes.
        view: record of `cube_sim.guidance.view_record.VIEW`; a target that stands still has no speed.
        dt: [s].
        velocity_time: of the velocity loop [s].
    """
    turning = levelled_turning(view[0].frame, path_turning(view))
    pushed = to_world(R, to_world(left[0].dragged, minus(triple(w), to_body(R, turning))))
    for i in range(3):
        leaving = pushed[i] - memory[0].shift[i] / (FORGETTING * velocity_time)
        memory[0].shift[i] += dt * leaving
        memory[0].pushed[i], memory[0].leaving[i] = pushed[i], leaving


@compiled
def begin_centre(left, memory, R, q, wish):
    """Begin as if the hull had turned from the attitude its mission wishes to where it is.

    Turning to that attitude then brings the shift back to none. Begun at none, it would have to be forgotten, with the
    hull beside its path meanwhile. The push D w of a turn by theta at an even rate adds up to R J(-theta) D theta,
    where J(theta) is the integral of exp(t S(theta)) over t from 0 to 1.

    Args:
        left: record of `cube_sim.control.authority.CAPABILITY`; of it D.
        memory: record `CENTRE`, begun if it is not.
        R: R_WB (3,3).
        q: the same attitude (4,).
        wish: the attitude that the mission asks for (4,).
    """
    m = memory[0]
    if m.started:
        return
    m.started = True
    theta = turn_between((wish[0], wish[1], wish[2], wish[3]), (q[0], q[1], q[2], q[3]))
    angle, pushed = length(theta), to_world(left[0].dragged, theta)
    if angle > SMALL_TURN_RAD:
        along = times(dot(theta, pushed) / angle**2, theta)
        aside = times((1.0 - cos(angle)) / angle**2, cross_tuples(theta, pushed))
        pushed = minus(plus(along, times(sin(angle) / angle, minus(pushed, along))), aside)
    shift = to_world(R, pushed)
    for i in range(3):
        m.shift[i] = shift[i]


@compiled
def see_centre(view, memory):
    """Turn a vehicle's view (record `cube_sim.guidance.view_record.VIEW`) into that of its centre of oscillation."""
    w, m = view[0], memory[0]
    shift, leaving = to_body(w.frame, triple(m.shift)), to_body(w.frame, triple(m.leaving))
    for i in range(3):
        w.error[i] -= shift[i]
        w.velocity[i] -= leaving[i]
