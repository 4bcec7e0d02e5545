"""Which attitude is wanted at a tick, of all kinds that compiled laws know, and the same balanced.

It is compiled by itself and called by its address: the rest of the law takes as long to compile.
"""

from __future__ import annotations

from cube_sim.control.along_path import nose_along
from cube_sim.control.balancing import balance
from cube_sim.control.free_attitude import least_effort
from cube_sim.control.look_at import look_at
from cube_sim.control.oscillation_centre import begin_centre
from cube_sim.native.compiled import compiled
from cube_sim.tuples import put, triple

ALONG_PATH, FIXED, LOOK_AT, FREE = range(4)
"""Which attitude is asked for: that of `AlongPath`, `FixedAttitude`, `LookAt` or `FreeAttitude`."""


@compiled
def want_attitude(parts, desired, view, R, q, dt, force_ratio):
    """The attitude of one tick.

    Args:
        parts: `cube_sim.control.answering.LawParts`, whose memories of the attitude are moved on.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`, zero, filled.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        R: R_WB (3,3).
        q: the same attitude (4,).
        dt: [s].
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    p, s, hull, current = parts, parts.settings[0], parts.hull, parts.current
    if s.kind == FIXED:
        put(desired[0].quaternion, s.attitude)
    elif s.kind == LOOK_AT:
        look_at(p.looking, p.sight, desired, view, R, dt)
    elif s.kind == FREE:
        force = triple(p.memory[0].force)
        least_effort(hull, p.effort, p.rest, desired, view, R, force, triple(current), dt)
    else:
        nose_along(s.levelling_time, p.side, desired, view, dt)
    if s.dragged:
        begin_centre(p.left, p.centre, R, q, desired[0].quaternion)
    if s.balanced:
        facets = p.balanced_normals, p.balanced_bounds, p.balanced_shares
        balance(hull, p.balancing, *facets, p.balanced, desired, view, R, p.memory, current, dt, force_ratio)
