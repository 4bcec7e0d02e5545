"""The centre of oscillation of a hull that turns by a force on a lever, compiled.

Where a torque comes with a force, a hull that begins to turn is first pushed the wrong way, as a torpedo with fins at
its stern is. Answering that, by its velocity, its place or its way of approach, would feed on itself. One point is not
moved by the push: the centre of oscillation. It is the point to bring onto the path.
"""

from __future__ import annotations

from math import inf

import numpy as np

from cube_sim.control.levelling import levelling_spin
from cube_sim.guidance.view_record import path_turning
from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, minus, plus, times, to_body, to_world, triple

FORGETTING = 4.0
"""How many times the time of the velocity loop it takes to forget how far turning has pushed the hull (a choice)."""

CENTRE = np.dtype([("shift", np.float64, 3), ("pushed", np.float64, 3), ("leaving", np.float64, 3)])
"""How far the hull is off because it has turned [m]; the velocity with which turning pushes it [m/s]; and that less
what is forgotten of the shift. World axes."""


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
def see_centre(view, memory):
    """Turn a vehicle's view (record `cube_sim.guidance.view_record.VIEW`) into that of its centre of oscillation."""
    w, m = view[0], memory[0]
    shift, leaving = to_body(w.frame, triple(m.shift)), to_body(w.frame, triple(m.leaving))
    for i in range(3):
        w.error[i] -= shift[i]
        w.velocity[i] -= leaving[i]
