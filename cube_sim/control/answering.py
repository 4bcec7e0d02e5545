"""All of a tick of the law for all axes in one compiled call, from the vehicle seen from its target to the wrench.

For guidance and attitude modes that compiled laws can read. The parts are those that `PathFollower` calls one by one
for any other: the numbers are the same.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.ceiling import keep_under_surface
from cube_sim.control.current import observe_current, told_of_water
from cube_sim.control.disturbance import observe_disturbance
from cube_sim.control.following import follow
from cube_sim.control.force_first import ForceFirst, serve_force_first
from cube_sim.control.oscillation_centre import see_centre, watch_centre
from cube_sim.control.own_law import OwnLawParts
from cube_sim.control.pace import LEAST_PACE
from cube_sim.control.refuge import look_back
from cube_sim.control.steering_by_fins import keep_course
from cube_sim.control.wanted_attitude import want_attitude
from cube_sim.guidance.approach import approach_motion
from cube_sim.guidance.pursuit import pursuit_motion
from cube_sim.guidance.speed import speed_at
from cube_sim.guidance.view_record import VIEW, see_level
from cube_sim.native.callee import Callee, call_at
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.tuples import put, triple

SETTINGS = np.dtype(
    [
        ("pursuit", np.bool_),
        ("kind", np.int64),
        ("balanced", np.bool_),
        ("dragged", np.bool_),
        ("budgeted", np.bool_),
        ("waits", np.bool_),
        ("level", np.bool_),
        ("force_first", np.bool_),
        ("disturbance_time", np.float64),
        ("current_time", np.float64),
        ("smeared_time", np.float64),
        ("current_damping", np.float64),
        ("levelling_time", np.float64),
        ("least_closing", np.float64),
        ("most_rest", np.float64, 2),
        ("attitude", np.float64, 4),
    ]
)
"""How a `PathFollower` is put together.

It pursues its target, or approaches the path; which attitude it asks for; the attitude is balanced; turning drags the
hull along; the thrusters' budget is known; the target waits; it moves in a level plane only; the force is served
before the torque. Then the times of the observers [s], 0 for none, the time over which what the current is read off
is smeared [s], 0 where the hull does not spin, the damping of that observer, the levelling time [s], the share of its
closing speed that the path's own speed is, the force and the torque
that are asked for again [N, N m], the attitude that is held.
"""


class LawParts(NamedTuple):
    """What a tick of the law reads and moves on beside the tick's own numbers.

    Attributes:
        settings: record `SETTINGS`.
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        loops: record of `cube_sim.control.loops.LOOPS`.
        left: record of `cube_sim.control.authority.CAPABILITY`.
        normals: of `ForceBudget`, like the next two.
        bounds: of it.
        held_shares: of it.
        ceiling: (3,n) of `cube_sim.control.ceiling.Ceiling.table`; (3,0) in endless water.
        force_first: read where the force is served before the torque.
        profile: of `cube_sim.guidance.speed.speed_at`, like the next two.
        nodes: of it.
        square: of it.
        approach: record of `cube_sim.guidance.approach.APPROACH`; read where it does not pursue.
        pursuit: record of `cube_sim.guidance.pursuit.PURSUIT`; read where it does.
        balancing: record of `cube_sim.control.balancing.BALANCE`; read where the attitude is balanced.
        balanced_normals: of the budget that the balanced attitude looks at, like the next two.
        balanced_bounds: of it.
        balanced_shares: of it.
        looking: record of `cube_sim.control.look_at.LOOK`; read where it looks at a point.
        effort: record of `cube_sim.control.free_attitude.EFFORT`; read where the attitude is free.
        side: memory of `nose_along`, moved on where that is asked for, as are the next two.
        sight: of `look_at`.
        rest: of `least_effort`.
        disturbance: memory of `observe_disturbance`, moved on.
        current: (3,) of `observe_current`, moved on.
        balanced: memory of `balance`, moved on.
        centre: memory of `watch_centre`, moved on.
        memory: of `follow`, moved on.
        refuge: record of `cube_sim.control.refuge.REFUGE`, moved on.
        shortage: record of `cube_sim.control.shortage.SHORTAGE`, over once the refuge is no more needed.
        course: record of `cube_sim.control.course_keeping.COURSE`, its water filled where fins steer.
        own: the law of the user's own that steers in place of cube_sim's; none where that does.
    """

    settings: Record
    hull: Record
    loops: Record
    left: Record
    normals: Matrix
    bounds: Vector
    held_shares: Vector
    ceiling: Matrix
    force_first: ForceFirst
    profile: Record
    nodes: Vector
    square: Vector
    approach: Record
    pursuit: Record
    balancing: Record
    balanced_normals: Matrix
    balanced_bounds: Vector
    balanced_shares: Vector
    looking: Record
    effort: Record
    side: Record
    sight: Record
    rest: Record
    disturbance: Record
    current: Vector
    balanced: Record
    centre: Record
    memory: Record
    refuge: Record
    shortage: Record
    course: Record
    own: OwnLawParts


def _want_attitude_of() -> tuple[Any, ...]:
    from cube_sim.control.compiled_parts import resting_law

    return resting_law(), np.zeros(1, DESIRED), np.zeros(1, VIEW), np.eye(3), np.zeros(4), 1.0, 1.0


WANTING = Callee(want_attitude, _want_attitude_of)


@compiled
def stay_in_refuge(parts, desired, force_ratio):
    """Want the refuge's attitude in place of the mission's; from the next tick on perhaps no more.

    Args:
        parts: `LawParts`.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`, that of the mission, filled.
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    p, wished, flow = parts, np.empty(4), np.empty(3)
    put(wished, desired[0].quaternion)
    for i in range(3):
        flow[i] = LEAST_PACE * p.memory[0].velocity[i] - p.current[i]
        desired[0].rates[i] = 0.0
    put(desired[0].quaternion, p.refuge[0].quaternion)
    facets, short = (p.normals, p.bounds, p.held_shares), p.shortage[0].since != 0.0
    if look_back(p.refuge, p.hull, *facets, force_ratio, flow, wished, short):
        p.shortage[0].pressed = False


@compiled
def answer(parts, view, desired, followed, R, q, v, w, applied, dt, force_ratio, wanting):
    """One tick.

    Args:
        parts: `LawParts`.
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
        wanting: address of the code of `cube_sim.control.wanted_attitude.want_attitude`.
    """
    p, s, hull, current = parts, parts.settings[0], parts.hull, parts.current
    seen, time = view, p.loops[0].velocity_time
    if s.dragged or s.level:
        seen = view.copy()
    if s.level:
        see_level(seen)
    if s.dragged:
        watch_centre(p.left, p.centre, R, w, view, dt, time)
        see_centre(seen, p.centre)
    speed, slope = speed_at(p.profile, p.nodes, p.square, view[0].arc_length)
    if s.pursuit:
        velocity, acceleration = pursuit_motion(seen, p.pursuit, slope)
    else:
        velocity, acceleration = approach_motion(seen, p.approach, speed, slope)
    facets = p.normals, p.bounds, p.held_shares
    keep_under_surface(p.ceiling, facets[0], facets[1], facets[2], force_ratio, view, velocity, acceleration, time)
    if s.dragged:
        acceleration += p.centre[0].pushed / time
    unknown = np.zeros(6)
    if s.disturbance_time > 0.0:
        observe_disturbance(hull, s.disturbance_time, p.disturbance, R, v, w, applied, current, dt)
        put(unknown, p.disturbance[0].estimate)
        if s.current_time > 0.0:
            share = dt * told_of_water(triple(w), s.smeared_time) / s.current_time
            observe_current(hull, s.current_damping, share, current, R, v, w, unknown)
    call_at(WANTING, wanting, (p, desired, view, R, q, dt, force_ratio))
    if p.refuge[0].taken:
        stay_in_refuge(p, desired, force_ratio)
    if p.course[0].steered:
        told = velocity, acceleration, unknown, current, dt, False
        keep_course(hull, p.course, p.loops, p.memory, followed, desired, view, R, q, v, w, *told)
        return
    follow(
        hull,
        p.loops,
        p.left,
        p.normals,
        p.bounds,
        p.held_shares,
        p.memory,
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
        s.least_closing,
        s.balanced,
        p.shortage[0].since,
    )
    if s.force_first:
        serve_force_first(p.force_first, p.normals, p.held_shares, force_ratio, followed[0].wrench)
