"""Set-points of actuators that no controller commands, from tables by time."""

from __future__ import annotations

from cube_sim.native.compiled import compiled

SAME_S = 1e-9
"""Times that differ by less are the same: those of ticks are rounded [s]."""
TIME, VALUE = 0, 1
"""Columns of a table of points: when [s], and the command then, in the actuator's own unit."""


@compiled
def setpoint_at(points, begin, end, t):
    """The command at a time: linear between two points, before the first and after the last as there.

    Of points at the same time, where it jumps, the last counts.

    Args:
        points: (n,2) of all tables, in each the times ascending.
        begin: the first of this one.
        end: the one behind its last.
        t: [s].
    """
    low, high = begin, end
    while low < high:
        middle = (low + high) // 2
        if points[middle, TIME] <= t + SAME_S:
            low = middle + 1
        else:
            high = middle
    if low == begin:
        return points[begin, VALUE]
    before = points[low - 1, VALUE]
    if low == end or points[low, VALUE] == before:
        return before
    share = (t - points[low - 1, TIME]) / (points[low, TIME] - points[low - 1, TIME])
    return before + max(share, 0.0) * (points[low, VALUE] - before)
