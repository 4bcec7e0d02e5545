"""Forces from outside on a hull: each sets in, holds and fades within given times."""

from __future__ import annotations

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, to_body

HULL, IN_BODY, POINT, FORCE, TORQUE, START = 0, 1, 2, 5, 8, 11
"""Columns of a table of pushes, a row each.

Number of the hull, -1 for none; whether force and torque are in body axes, else in world axes; the point at which the
force acts (3), from the body origin in body axes [m]; force (3) [N]; torque (3) [N m]; and four times that do not
decrease [s]: the push grows from the first to the second, is whole until the third, and has faded at the fourth.
"""
COLUMNS = 15


@compiled
def share_at(time, starts, whole, fades, ends):
    """Which share of a push acts at a time [s], 0 to 1; the other times as in the table."""
    if time < starts or time >= ends:
        return 0.0
    if time < whole:
        return (time - starts) / (whole - starts)
    if time < fades:
        return 1.0
    return (ends - time) / (ends - fades)


@compiled
def _grown(time, starts, whole):
    """Integral up to a time of what grows from 0 to 1 between two others, and stays [s]."""
    if time <= starts:
        return 0.0
    if time >= whole:
        return time - 0.5 * (starts + whole)
    return 0.5 * (time - starts) * (time - starts) / (whole - starts)


@compiled
def mean_share(time, step, starts, whole, fades, ends):
    """Mean of `share_at` over one time step, from half a step before to half a step after.

    An integrator that meets a jump within a step is off by a share of that step. The weights of Runge-Kutta's stages,
    and of Euler's steps, add the mean up to the whole impulse, wherever in a step the jump lies. Nothing before time 0
    is in it, where a simulation starts.
    """
    before, after = 0.5 * step, 0.5 * step
    if 0.0 <= time < before:
        before = time
    early, late = time - before, time + after
    if late <= starts or early >= ends:
        return 0.0
    if early >= whole and late <= fades:
        return 1.0
    grown = _grown(late, starts, whole) - _grown(early, starts, whole)
    return (grown - (_grown(late, fades, ends) - _grown(early, fades, ends))) / (late - early)


@compiled
def push_wrench(pushes, hull, R_WB, time, step):
    """The wrench of all pushes on a hull, a 6-tuple [N, N m], in body axes at the body origin.

    Args:
        pushes: (n, `COLUMNS`) their table.
        hull: number of the hull.
        R_WB: attitude (3,3), body to world.
        time: [s].
        step: the time step over which the mean is taken [s]; 0 for the pushes at that time.
    """
    fx, fy, fz, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(pushes.shape[0]):
        p = pushes[k]
        if p[HULL] != hull:
            continue
        if step > 0.0:
            share = mean_share(time, step, p[START], p[START + 1], p[START + 2], p[START + 3])
        else:
            share = share_at(time, p[START], p[START + 1], p[START + 2], p[START + 3])
        if share == 0.0:
            continue
        f = (share * p[FORCE], share * p[FORCE + 1], share * p[FORCE + 2])
        m = (share * p[TORQUE], share * p[TORQUE + 1], share * p[TORQUE + 2])
        if p[IN_BODY] == 0.0:
            f, m = to_body(R_WB, f), to_body(R_WB, m)
        moment = cross_tuples((p[POINT], p[POINT + 1], p[POINT + 2]), f)
        fx, fy, fz = fx + f[0], fy + f[1], fz + f[2]
        mx, my, mz = mx + m[0] + moment[0], my + m[1] + moment[1], mz + m[2] + moment[2]
    return (fx, fy, fz, mx, my, mz)
