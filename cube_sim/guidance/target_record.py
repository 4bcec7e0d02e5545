"""Both targets as compiled laws read them: one that waits for the vehicle, and one that runs by the clock."""

from __future__ import annotations

from math import inf

import numpy as np

from cube_sim.guidance.speed import ConstantSpeed, Parts
from cube_sim.guidance.view_record import see
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record

TARGET = np.dtype([("clocked", np.bool_), *((name, np.float64) for name in ("gain", "speed_limit", "first", "last"))])
"""Whether it is a `ClockedTarget`; the numbers of a `VirtualTarget`: k2 [1/s] and the bound on |s'| [m/s]; the arc
lengths between which it runs [m], the last one also where a clocked one leaves the path."""
RunningParts = tuple[Record, Parts]
"""Record, and the planned speed that a clocked target keeps."""
NO_PLAN: Parts = ConstantSpeed(1.0).parts


def virtual(gain: float, speed_limit: float, first: float, last: float) -> Record:
    """The record of a `VirtualTarget`."""
    return np.array([(False, gain, speed_limit, first, last)], TARGET)


def clocked(last: float) -> Record:
    """The record of a `ClockedTarget`."""
    return np.array([(True, 0.0, inf, -inf, last)], TARGET)


@compiled
def see_from_target(view, target, row, planned, arc_length, position, velocity_W):
    """Fill a record `VIEW`.

    Args:
        view: filled.
        target: record `TARGET`.
        row: (16,) the path at the target, or at its end where a clocked one has passed that: changed to run on then.
        planned: speed there [m/s], of a clocked target.
        arc_length: of the target [m].
        position: p_WB (3,) [m].
        velocity_W: over ground (3,) [m/s], world axes.
    """
    t, w = target[0], view[0]
    if t.clocked and arc_length > t.last:
        for i in range(3):
            row[i] += (arc_length - t.last) * row[3 + 3 * i]
        for i in range(4):
            row[12 + i] = 0.0
    see(view, row, arc_length, t.last - arc_length, position, velocity_W)
    if t.clocked:
        w.speed = planned
        return
    speed = min(max(w.velocity[0] + t.gain * w.error[0], -t.speed_limit), t.speed_limit)
    if (arc_length <= t.first and speed < 0.0) or (arc_length >= t.last and speed > 0.0):
        speed = 0.0
    w.speed = speed


@compiled
def advanced(target, slope, arc_length, speed, dt):
    """Where the target is after dt [s] at s' = speed [m/s].

    A virtual one never passes an end of its run. For a clocked one these are two terms of the series of s(t), exact for
    a speed that changes evenly in time.

    Args:
        target: record `TARGET`.
        slope: of the planned speed at the target [1/s], of a clocked one.
        arc_length: of the target [m].
        speed: s' [m/s].
        dt: [s].
    """
    if target[0].clocked:
        return arc_length + dt * speed * (1.0 + 0.5 * dt * slope)
    return min(max(arc_length + speed * dt, target[0].first), target[0].last)
