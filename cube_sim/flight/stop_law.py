"""Whether a flight is to stop, from the rows of a tick: one compiled law for both loops."""

from __future__ import annotations

from math import sqrt

from cube_sim.mission.stopping import PATH_END, RESTING, TIMED
from cube_sim.native.compiled import compiled

SAME_S = 1e-9
"""Times that differ by less are the same: those of ticks are rounded [s]."""


@compiled
def _row(rows, table, k):
    """Row k of the table with this number, in the order of `TickRows` without its first."""
    if table == 0:
        return rows.pose[k]
    if table == 1:
        return rows.velocity[k]
    if table == 2:
        return rows.target[k]
    if table == 3:
        return rows.path_error[k]
    if table == 4:
        return rows.reference[k]
    if table == 5:
        return rows.wrench[k]
    if table == 6:
        return rows.allocation[k]
    if table == 7:
        return rows.thrusters[k]
    if table == 8:
        return rows.power[k]
    if table == 9:
        return rows.health[k]
    if table == 10:
        return rows.water[k]
    if table == 11:
        return rows.disturbance[k]
    if table == 12:
        return rows.fins[k]
    if table == 13:
        return rows.setpoints[k]
    return rows.joints[k]


@compiled
def stop_value(stop, rows, k):
    """What a condition looks at: a number of row k, the norm of several, or the distance to the end of the path [m]."""
    if stop.kind == PATH_END:
        vehicle, target, square = rows.pose[k], rows.target[k], 0.0
        for i in range(3):
            off = vehicle[1 + i] - target[3 + i]
            square += off * off
        return sqrt(square) + abs(target[2])
    row = _row(rows, stop.table, k)
    if stop.count == 1:
        return row[stop.first]
    square = 0.0
    for i in range(stop.count):
        square += row[stop.first + i] * row[stop.first + i]
    return sqrt(square)


@compiled
def condition_met(stops, rows, k, t):
    """Number of the first condition that has held for its time at one tick, or whose time is over, -1 for none.

    Args:
        stops: (n,) of `cube_sim.mission.stopping.STOP`, moved on.
        rows: `cube_sim.flight.rows.TickRows`.
        k: which of them.
        t: simulated time [s].
    """
    met = -1
    for i in range(len(stops)):
        stop = stops[i]
        if stop.kind == RESTING:
            continue
        if stop.kind == TIMED:
            holds = t >= stop.limit - SAME_S
        else:
            value = stop_value(stop, rows, k)
            holds = t >= stop.from_s and (value > stop.limit if stop.above else value < stop.limit)
            holds = holds and rows.path_error[k, 5] <= stop.turned
        stop.held = stop.held + 1 if holds else 0
        if met < 0 and (stop.held > stop.ticks or t >= stop.until - SAME_S):
            met = i
    return met
