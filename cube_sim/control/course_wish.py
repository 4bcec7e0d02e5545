"""The trim of a course as the attitude wished for, compiled; which trim is found in `cube_sim.control.course_trim`."""

from __future__ import annotations

from math import acos, asin, hypot

from cube_sim.guidance.view_record import path_turning
from cube_sim.native.compiled import compiled
from cube_sim.tuples import put, quaternion_from_matrix

SLOWEST_M_S = 0.03
"""A course through the water that is slower has no trim to look for (a choice)."""
STEEP = 0.2
"""Share of its speed below which the horizontal part of a course gives no direction: it keeps the one it had."""
OTHER_RAD = 0.35
"""A course that climbs by so much more or less, or a wish that is so far from the one judged, is judged anew."""
OTHER_SPEED = 0.25
"""As is a speed that has changed by this share."""
SELDOM_S = 4.0
"""But not before so long [s] (a choice)."""
ENDING_S = 30.0
"""Nor once its path ends within so long [s] at the present speed, or has ended (a choice): it slows down then, and to
turn over for what is left would move it farther than the trim it has."""


@compiled
def _rows(q):
    """Rows of the rotation (3,3) of a quaternion (4,)."""
    w, x, y, z = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


@compiled
def wish_for_trim(p, m, out, view, R_now, speed, current_W, dt):
    """Look at the course through the water, and put the trim chosen for it in place of what the mission wishes.

    Args:
        p: element of a record `cube_sim.control.balancing.BALANCE`.
        m: element of its `MEMORY`, moved on.
        out: element of a record of `cube_sim.control.attitude_mode.DESIRED`: the mission's wish, replaced.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        R_now: R_WB (3,3) of the hull.
        speed: along the path [m/s].
        current_W: (3,) [m/s], world axes.
        dt: [s].
    """
    ending = view[0].arc_length > 0.0 and view[0].remaining < ENDING_S * speed
    if not view[0].remaining > 0.0:
        speed = 0.0  # a point, or past the end: its direction is none to go in
    frame = view[0].frame
    x, y = speed * frame[0, 0] - current_W[0], speed * frame[1, 0] - current_W[1]
    z = speed * frame[2, 0] - current_W[2]
    level = hypot(x, y)
    m.speed = hypot(level, z)
    m.since += dt
    if not m.speed > SLOWEST_M_S:
        m.stale = False
    else:
        m.climb = asin(min(max(z / m.speed, -1.0), 1.0))
        if level > STEEP * m.speed:
            m.heading[0], m.heading[1] = x / level, y / level
        elif m.heading[0] == 0.0 and m.heading[1] == 0.0:
            nose = hypot(R_now[0, 0], R_now[1, 0])
            m.heading[0], m.heading[1] = (R_now[0, 0] / nose, R_now[1, 0] / nose) if nose > 0.0 else (1.0, 0.0)
        wish = _rows(out.quaternion)
        trace = 0.0
        for j in range(3):
            ahead = m.heading[0] * wish[0][j] + m.heading[1] * wish[1][j]
            aside = m.heading[0] * wish[1][j] - m.heading[1] * wish[0][j]
            m.course_wish[0, j], m.course_wish[1, j], m.course_wish[2, j] = ahead, aside, wish[2][j]
            trace += ahead * p.judged_wish[0, j] + aside * p.judged_wish[1, j] + wish[2][j] * p.judged_wish[2, j]
        turned = acos(min(max((trace - 1.0) / 2.0, -1.0), 1.0))
        other = abs(m.speed - p.judged_speed) > OTHER_SPEED * p.judged_speed
        other = other or turned > OTHER_RAD or abs(m.climb - p.judged_climb) > OTHER_RAD
        m.stale = other and (p.judged_speed == 0.0 or (m.since > SELDOM_S and not ending))
    if p.trimmed:
        R = R_now.copy()
        for j in range(3):
            R[0, j] = m.heading[0] * p.trim[0, j] - m.heading[1] * p.trim[1, j]
            R[1, j] = m.heading[1] * p.trim[0, j] + m.heading[0] * p.trim[1, j]
            R[2, j] = p.trim[2, j]
        put(out.quaternion, quaternion_from_matrix(R))
        out.rates[0], out.rates[1], out.rates[2] = 0.0, 0.0, path_turning(view)[2]
