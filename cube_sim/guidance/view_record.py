"""The vehicle as seen from its target, compiled."""

from __future__ import annotations

import numpy as np

from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import point_of_row
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record
from cube_sim.tuples import minus, put, times

VIEW = np.dtype(
    [
        ("arc_length", np.float64),
        ("remaining", np.float64),
        ("speed", np.float64),
        ("row", np.float64, 16),
        ("frame", np.float64, (3, 3)),
        ("error", np.float64, 3),
        ("velocity", np.float64, 3),
    ]
)
"""`TargetView`, whose names these are; row is the path's point as `cube_sim.guidance.path_record.path_row` gives it,
frame its R_WF."""


@compiled
def see(view, row, arc_length, remaining, position, velocity_W):
    """Fill a record `VIEW` but for the target's speed.

    Args:
        view: filled.
        row: (16,) the path at the target.
        arc_length: of the target [m].
        remaining: from there to the end [m].
        position: p_WB (3,) [m].
        velocity_W: over ground (3,) [m/s], world axes.
    """
    w = view[0]
    w.arc_length, w.remaining = arc_length, remaining
    put(w.row, row)
    for j in range(3):
        w.error[j] = w.velocity[j] = 0.0
        for i in range(3):
            w.frame[i, j] = row[3 + 3 * i + j]
            w.error[j] += (position[i] - row[i]) * w.frame[i, j]
            w.velocity[j] += velocity_W[i] * w.frame[i, j]


@compiled
def see_level(view):
    """Take height out of a vehicle's view: one that moves in a level plane only can do nothing about it.

    Left in, a hull that has left its depth would head for it, and slow down along its path for that.
    """
    w = view[0]
    for change in (w.error, w.velocity):
        up = w.frame[2, 0] * change[0] + w.frame[2, 1] * change[1] + w.frame[2, 2] * change[2]
        for i in range(3):
            change[i] -= up * w.frame[2, i]


@compiled
def path_turning(view):
    """How fast the path frame turns with the target, a 3-tuple [rad/s], world axes: s' [0, -k2, k1] about its axes."""
    w = view[0]
    N1, N2 = (w.frame[0, 1], w.frame[1, 1], w.frame[2, 1]), (w.frame[0, 2], w.frame[1, 2], w.frame[2, 2])
    return times(w.speed, minus(times(w.row[12], N2), times(w.row[13], N1)))


def view_of(record: Record) -> TargetView:
    """The view whose numbers a compiled law has filled in."""
    view = record[0]
    return TargetView(
        float(view["arc_length"]),
        float(view["remaining"]),
        float(view["speed"]),
        point_of_row(view["row"]),
        view["error"],
        view["velocity"],
    )


def record_of(view: TargetView) -> Record:
    """The numbers of a view, as compiled laws read them."""
    record = np.zeros(1, VIEW)
    point = view.point
    record["arc_length"], record["remaining"], record["speed"] = view.arc_length, view.remaining, view.speed
    record["row"] = np.concatenate([point.position, point.rotation.ravel(), point.curvature, point.curvature_rate])
    record["frame"], record["error"], record["velocity"] = point.rotation, view.error, view.velocity
    return record
