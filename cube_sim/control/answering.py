"""All of a tick of the law for all axes in one compiled call, from the vehicle seen from its target to the wrench.

For guidance and attitude modes that compiled laws can read. The parts are those that `PathFollower` calls one by one
for any other: the numbers are the same.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.along_path import nose_along
from cube_sim.control.balancing import balance
from cube_sim.control.current import observe_current
from cube_sim.control.disturbance import observe_disturbance
from cube_sim.control.following import follow
from cube_sim.control.oscillation_centre import begin_centre, see_centre, watch_centre
from cube_sim.guidance.approach import approach_motion
from cube_sim.guidance.pursuit import pursuit_motion
from cube_sim.guidance.speed import speed_at
from cube_sim.native.compiled import compiled

SETTINGS = np.dtype(
    [
        ("pursuit", np.bool_),
        ("fixed", np.bool_),
        ("balanced", np.bool_),
        ("dragged", np.bool_),
        ("budgeted", np.bool_),
        ("waits", np.bool_),
        ("disturbance_time", np.float64),
        ("current_time", np.float64),
        ("current_damping", np.float64),
        ("levelling_time", np.float64),
        ("most_rest", np.float64),
        ("attitude", np.float64, 4),
    ]
)
"""How a `PathFollower` is put together.

It pursues its target, or approaches the path; it holds one attitude, or the path's; the attitude is balanced; turning
drags the hull along; the thrusters' budget is known; the target waits. Then the times of the observers [s], 0 for none,
the damping of the current's, the levelling time [s], the force that is asked for again [N], the attitude that is held.
"""


@compiled
def answer(
    settings,
    hull,
    loops,
    left,
    normals,
    bounds,
    held_shares,
    profile,
    nodes,
    square,
    approach,
    pursuit,
    balancing,
    balanced_normals,
    balanced_bounds,
    balanced_shares,
    disturbance,
    current,
    side,
    balanced,
    centre,
    memory,
    view,
    desired,
    followed,
    R,
    q,
    v,
    w,
    applied,
    dt,
    force_ratio,
):
    """One tick; the arguments that are not said here are those of the parts.

    Args:
        settings: record `SETTINGS`.
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        loops: record of `cube_sim.control.loops.LOOPS`.
        left: record of `cube_sim.control.authority.CAPABILITY`.
        normals: of `ForceBudget`, like the next two.
        bounds: of it.
        held_shares: of it.
        profile: of `cube_sim.guidance.speed.speed_at`, like the next two.
        nodes: of it.
        square: of it.
        approach: record of `cube_sim.guidance.approach.APPROACH`; read where it does not pursue.
        pursuit: record of `cube_sim.guidance.pursuit.PURSUIT`; read where it does.
        balancing: record of `cube_sim.control.balancing.BALANCE`; read where the attitude is balanced.
        balanced_normals: of the budget that the balanced attitude looks at, like the next two.
        balanced_bounds: of it.
        balanced_shares: of it.
        disturbance: memory of `observe_disturbance`, moved on.
        current: (3,) of `observe_current`, moved on.
        side: memory of `nose_along`, moved on.
        balanced: memory of `balance`, moved on.
        centre: memory of `watch_centre`, moved on.
        memory: of `follow`, moved on.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`, zero, filled.
        followed: record of `cube_sim.control.following.FOLLOWED`, filled.
        R: R_WB (3,3).
        q: the same attitude (4,).
        v: over ground (3,) [m/s], body axes.
        w: (3,) [rad/s], body axes.
        applied: wrench (6,) allocated over the tick before.
        dt: [s].
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    s, seen, time = settings[0], view, loops[0].velocity_time
    if s.dragged:
        watch_centre(left, centre, R, w, view, dt, time)
        seen = view.copy()
        see_centre(seen, centre)
    speed, slope = speed_at(profile, nodes, square, view[0].arc_length)
    if s.pursuit:
        velocity, acceleration = pursuit_motion(seen, pursuit, slope)
    else:
        velocity, acceleration = approach_motion(seen, approach, speed, slope)
    if s.dragged:
        acceleration += centre[0].pushed / time
    unknown = np.zeros(6)
    if s.disturbance_time > 0.0:
        observe_disturbance(hull, s.disturbance_time, disturbance, R, v, w, applied, current, dt)
        unknown[:] = disturbance[0].estimate
        if s.current_time > 0.0:
            observe_current(hull, s.current_damping, dt / s.current_time, current, R, v, w, unknown)
    if s.fixed:
        desired[0].quaternion[:] = s.attitude
    else:
        nose_along(s.levelling_time, side, desired, view, dt)
    if s.dragged:
        begin_centre(left, centre, R, q, desired[0].quaternion)
    if s.balanced:
        facets = balanced_normals, balanced_bounds, balanced_shares
        balance(hull, balancing, *facets, balanced, desired, R, memory, current, dt, force_ratio)
    follow(
        hull,
        loops,
        left,
        normals,
        bounds,
        held_shares,
        memory,
        followed,
        R,
        q,
        v,
        w,
        velocity,
        acceleration,
        desired,
        unknown,
        current,
        view,
        applied,
        force_ratio,
        s.most_rest,
        s.budgeted,
        s.waits,
        s.balanced,
    )
