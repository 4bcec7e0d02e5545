"""The attitude whose nose follows the path."""

from __future__ import annotations

import numpy as np

from cube_sim.control.attitude_mode import DESIRED, DesiredAttitude, Situation
from cube_sim.control.levelling import levelling_spin
from cube_sim.control.turning_on import tell_attitude
from cube_sim.guidance.view_record import path_turning, record_of
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record
from cube_sim.tuples import cross_tuples, dot, length, minus, plus, times, triple

MEMORY = np.dtype([("side", np.float64, 3), ("started", np.bool_)])
"""The side axis, world axes, and whether there is one yet."""


class AlongPath:
    """Body x along the path's tangent T, body y level, no roll.

    Level means nothing where the path is vertical, so the law steers to it instead of reading it off the tangent. The
    side axis is carried along without spin (parallel transport) and turned about T by `levelling_spin`. On ordinary
    paths it stays level. Through a vertical stretch the heading is kept. After a half loop the vehicle rolls out of its
    upside-down attitude instead of jumping.

    Args:
        levelling_time: [s].
    """

    def __init__(self, levelling_time: float = 2.0) -> None:
        self.levelling_time = levelling_time
        self.memory: Record = np.zeros(1, MEMORY)

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The attitude at the target's point of the path, and how it turns as the target runs on."""
        desired = np.zeros(1, DESIRED)
        nose_along(self.levelling_time, self.memory, desired, record_of(situation.view), dt)
        return DesiredAttitude(*desired[0])


@compiled
def nose_along(levelling_time, memory, answer, view, dt):
    """One tick of the law.

    Args:
        levelling_time: [s].
        memory: record `MEMORY`, moved on.
        answer: record `DESIRED`, filled.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        dt: [s].
    """
    m, frame = memory[0], view[0].frame
    T, N1 = (frame[0, 0], frame[1, 0], frame[2, 0]), (frame[0, 1], frame[1, 1], frame[2, 1])
    turning = path_turning(view)
    if not m.started:
        m.started = True
        level = cross_tuples((0.0, 0.0, 1.0), T)
        h = length(level)
        first = N1 if h < 1e-9 else times(1.0 / h, level)
        for i in range(3):
            m.side[i] = first[i]
    side = minus(triple(m.side), times(dot(triple(m.side), T), T))
    side = times(1.0 / length(side), side)
    top = cross_tuples(T, side)
    rates = plus(turning, times(levelling_spin(T, cross_tuples(turning, T), side, levelling_time), T))
    turned = plus(side, times(dt, cross_tuples(rates, side)))
    turned = times(1.0 / length(turned), turned)
    R = np.empty((3, 3))
    for i in range(3):
        m.side[i] = turned[i]
        R[i, 0], R[i, 1], R[i, 2] = T[i], side[i], top[i]
    tell_attitude(answer, R, rates)
