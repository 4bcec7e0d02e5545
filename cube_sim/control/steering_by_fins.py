"""The law of a vehicle that its fins steer, from the motion wanted to heading, rates and wrench, compiled.

What it is told is worked out in `cube_sim.control.course_keeping`.
"""

from __future__ import annotations

from math import atan2, sqrt

import numpy as np

from cube_sim.control.turned_away import turns_away
from cube_sim.control.turning_on import tell_attitude
from cube_sim.native.compiled import compiled
from cube_sim.tuples import (
    cross_tuples,
    dot,
    length,
    minus,
    minus6,
    plus,
    rotated,
    sextuple,
    stacked,
    times,
    to_body,
    to_world,
    triple,
    turn_between,
)
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics, steady_wrench

WAY = 0.7
"""Share of the speed wanted that the hull keeps through the water: there its fins make half as much (a choice)."""
SLOWEST, FASTEST = 0.4, 1.5
"""Shares of the speed of the path between which the flow is reckoned with (choices): slower, fins make nothing."""
STEEPEST = 0.87
"""Sine of the inclination, 60 degrees, beyond which its nose is not asked to point (a choice)."""
LITTLE_M_S = 1e-6
"""At the end of a path it is wanted to go on at this speed, so that it knows where its nose is to point."""
HEADED_RAD, MOST_COURSE_ERROR_RAD, MOST_LEARNED_RAD = 0.15, 0.2, 0.15
"""How near its heading a hull is that learns of its course over ground, how large an error of that counts, and how much
it learns at most (choices)."""
ENDING = 2.0
"""Where its path is to be stopped at, it glides from so many times the attitude's time before the end (a choice)."""


@compiled
def keep_course(
    hull,
    course,
    loops,
    memory,
    answer,
    desired,
    view,
    R,
    q,
    v,
    w,
    velocity_W,
    acceleration_W,
    unknown,
    current_W,
    dt,
    holds,
):
    """One tick of the law.

    The heading is that of U = v_d - v_c, the velocity wanted through the water, turned by the slip that balances what a
    turn asks for, weight and lift, and what the model does not explain. The attitude is turned to it no faster than the
    fins stop again. The torque is that of the model; forces across the hull come with it as the fins make them.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        course: record of `cube_sim.control.course_keeping.COURSE`, its water filled.
        loops: record of `cube_sim.control.loops.LOOPS`.
        memory: record of `cube_sim.control.asked.MEMORY`, moved on.
        answer: record of `cube_sim.control.following.FOLLOWED`, filled.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`, filled.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        R: R_WB (3,3).
        q: the same attitude (4,).
        v: over ground (3,) [m/s], body axes.
        w: (3,) [rad/s], body axes.
        velocity_W: desired (3,) [m/s], world axes.
        acceleration_W: desired (3,) [m/s^2], world axes.
        unknown: estimate (6,) of what the model does not explain [N, N m], body axes.
        current_W: estimate (3,) [m/s], world axes.
        dt: [s].
        holds: whether it is to stay about a place, which it can only circle.
    """
    c, k, m, out = course[0], loops[0], memory[0], answer[0]
    rates, speed, water, rest = triple(w), triple(v), triple(current_W), sextuple(unknown)
    flow = minus(speed, to_body(R, water))
    share = min(max(flow[0] / c.speed, SLOWEST), FASTEST)
    wanted, ends = triple(velocity_W), False
    if not holds:
        wanted, ends = gliding(view, wanted, c.speed, ENDING * c.speed * k.attitude_time)
    through = velocity_through_water(wanted, water, ends)
    fast = length(through)
    R_0 = level_axes(R, through)
    turning = (0.0, 0.0, 0.0)
    if fast > 1e-6 and not ends:
        turning = times(1.0 / (fast * fast), cross_tuples(through, triple(acceleration_W)))
    q_0, r_0 = to_body(R_0, turning)[1:]
    most_q, most_r = c.most_rate[0] * share, c.most_rate[1] * share
    q_0, r_0 = min(max(q_0, -most_q), most_q), min(max(r_0, -most_r), most_r)
    aside, up = slip_of(hull, course, R_0, share, q_0, r_0, rest)
    aside, up = aside - c.learned[1], up - c.learned[0]
    lean = sqrt(aside * aside + up * up)
    R_d = R_0 if lean == 0.0 else rotated(R_0, (0.0, up / lean, -aside / lean), lean)
    with_course = to_world(R_0, (0.0, q_0, r_0))
    tell_attitude(desired, R_d, with_course)
    to = desired[0].quaternion
    turn = turn_between((q[0], q[1], q[2], q[3]), (to[0], to[1], to[2], to[3]))
    w_d = to_body(R, with_course)
    w_ref = (
        min(max(w_d[0] + turn[0] / k.attitude_time, -k.most_rate), k.most_rate),
        min(max(w_d[1] + turn[1] / k.attitude_time, -most_q), most_q),
        min(max(w_d[2] + turn[2] / k.attitude_time, -most_r), most_r),
    )
    dw = times(1.0 / k.rate_time, minus(w_ref, rates))
    # As it turns on, the rate wanted falls; not where it is at its bound.
    about_y = dw[1] + ((w_d[1] - rates[1]) / k.attitude_time if abs(w_ref[1]) < most_q else 0.0)
    about_z = dw[2] + ((w_d[2] - rates[2]) / k.attitude_time if abs(w_ref[2]) < most_r else 0.0)
    dw = (dw[0], about_y, about_z)
    if not ends and length(turn) < HEADED_RAD and abs(w_ref[1]) < most_q and abs(w_ref[2]) < most_r:
        learn(c, to_body(R_0, wanted), to_body(R_0, to_world(R, speed)), dt)
    tau = minus6(inverse_dynamics(hull, R, stacked(speed, rates), stacked((0.0, 0.0, 0.0), dw), water), rest)
    M = hull[0].total_mass
    roll = atan2(R[2, 1], R[2, 2])  # its righting moment is left to help
    about_x = -rest[3] - M[3, 3] * (2.0 * rates[0] + roll / k.attitude_time) / k.attitude_time
    surge = steady_wrench(hull, (fast, 0.0, 0.0), (R[2, 0], R[2, 1], R[2, 2]))[0] - rest[0]
    surge += M[0, 0] * (fast - flow[0]) / k.velocity_time
    drift = drift_in(course, rest, share)
    if turns_away(course, minus(flow, drift), rates, w_ref, share, k.attitude_time, dt):
        surge = min(surge, 0.0)
    if ends:
        surge = max(surge, 0.0)  # astern, the propeller would take the flow off the fins
    velocity, force = to_body(R, wanted), to_world(R, (surge, 0.0, 0.0))
    for i in range(6):
        asked = c.makes[i, 0] * surge + c.makes[i, 1] * about_x + c.makes[i, 2] * tau[4] + c.makes[i, 3] * tau[5]
        m.asked[i] = out.wrench[i] = asked
    m.has_asked = True
    seen = plus(water, to_world(R, drift))
    for i in range(3):
        m.force[i], m.velocity[i], m.torque[i] = force[i], wanted[i], tau[3 + i]
        out.velocity[i], out.rates[i], c.water[i] = velocity[i], w_ref[i], seen[i]
    out.attitude_error, out.pace, out.enough = length(turn), 1.0, True


@compiled
def learn(c, wanted, gone, dt):
    """Learn by how much heading and pitch are to be others, for the course over ground to be the one wanted.

    Slips are reckoned with as the model has them. What is wrong in it would leave the hull beside its path, so far that
    the approach makes up for it.

    Args:
        c: of the record `COURSE`.
        wanted: velocity over ground, a 3-tuple [m/s], axes of the course.
        gone: the hull's own, likewise.
        dt: [s].
    """
    fast, went = length(wanted), length(gone)
    if fast < 1e-3 or went < SLOWEST * c.speed:
        return
    up = wanted[2] / fast - gone[2] / went
    left = (gone[0] * wanted[1] - gone[1] * wanted[0]) / (fast * went)
    share = dt / c.learning_time
    up = c.learned[0] + share * min(max(up, -MOST_COURSE_ERROR_RAD), MOST_COURSE_ERROR_RAD)
    left = c.learned[1] + share * min(max(left, -MOST_COURSE_ERROR_RAD), MOST_COURSE_ERROR_RAD)
    c.learned[0] = min(max(up, -MOST_LEARNED_RAD), MOST_LEARNED_RAD)
    c.learned[1] = min(max(left, -MOST_LEARNED_RAD), MOST_LEARNED_RAD)


@compiled
def gliding(view, velocity_W, speed, before):
    """The velocity wanted (3-tuple), world axes, and whether the hull glides to the end of its path.

    Slower, its fins lose it. So where the path is to end, and the speed along it to fall, it is wanted to keep to the
    last tangent until it has stopped.

    Args:
        view: record of `cube_sim.guidance.view_record.VIEW`.
        velocity_W: 3-tuple [m/s].
        speed: of the path [m/s].
        before: how far before the end that begins [m].
    """
    s = view[0]
    T = (s.frame[0, 0], s.frame[1, 0], s.frame[2, 0])
    along = dot(velocity_W, T)
    if s.remaining - s.error[0] > before or along > WAY * speed:
        return velocity_W, False
    return times(max(along, LITTLE_M_S), T), True


@compiled
def velocity_through_water(wanted_W, water_W, ends):
    """The velocity wanted through the water, a 3-tuple [m/s], world axes.

    With the current behind it a hull keeps `WAY` of its speed wanted through the water, in the direction in which it is
    carried the right way over ground. Where that is to stop, it does not make up for the current.

    Args:
        wanted_W: over ground, a 3-tuple [m/s].
        water_W: the current (3-tuple) [m/s].
        ends: whether it glides to an end.
    """
    fast = length(wanted_W)
    if ends:
        return times(max(1.0 - dot(water_W, wanted_W) / (fast * fast), 1e-9), wanted_W)
    through, way = minus(wanted_W, water_W), WAY * fast
    if length(through) >= way or fast < 1e-6:
        return through
    T = times(1.0 / fast, wanted_W)
    across = minus(water_W, times(dot(water_W, T), T))
    along = way * way - dot(across, across)
    turned = minus(times(sqrt(max(along, 0.0)), T), across)
    return times(way / max(length(turned), 1e-9), turned)


@compiled
def level_axes(R, ahead_W):
    """Axes (3,3), the first along a velocity (3-tuple), no steeper than `STEEPEST`, the second level; world axes."""
    fast = length(ahead_W)
    x, y, z = times(1.0 / fast, ahead_W) if fast > 0.0 else (R[0, 0], R[1, 0], R[2, 0])
    if x * x + y * y < 1e-12:  # straight up or down: it keeps its heading
        x, y = R[0, 0], R[1, 0]
    flat, z = sqrt(x * x + y * y), min(max(z, -STEEPEST), STEEPEST)
    cos_h, sin_h = (x / flat, y / flat) if flat > 1e-6 else (1.0, 0.0)
    level = sqrt(1.0 - z * z)
    axes = np.empty((3, 3))
    axes[0, 0], axes[1, 0], axes[2, 0] = level * cos_h, level * sin_h, z
    axes[0, 1], axes[1, 1], axes[2, 1] = -sin_h, cos_h, 0.0
    axes[0, 2], axes[1, 2], axes[2, 2] = -z * cos_h, -z * sin_h, level
    return axes


@compiled
def drift_in(course, unknown, share):
    """By how much faster the water would flow for the hull to be pushed so, a 3-tuple [m/s], body axes.

    Water that is not known yet pushes a hull aside and turns it by its slip; so does a fin, on its own lever. What is
    not explained is taken for the two together. So a fin that makes less than is reckoned is no water: turned into a
    flow that is not there, it would make less still.

    Args:
        course: record of `cube_sim.control.course_keeping.COURSE`.
        unknown: wrench (6-tuple) that the model does not explain [N, N m], body axes.
        share: of the speed through the water in that of the path.
    """
    aside, up = slip_under(course, -1.0 / share, (unknown[1], unknown[2], unknown[4], unknown[5]))
    return 0.0, aside, up


@compiled
def slip_under(course, by, load):
    """Slip velocities aside and up, a pair, at which hull and fins balance a load, times a factor.

    Args:
        course: record of `cube_sim.control.course_keeping.COURSE`.
        by: the factor.
        load: (Y, Z, M, N), a 4-tuple [N, N m].
    """
    s = course[0].slips
    aside = by * (s[0, 0] * load[0] + s[0, 1] * load[1] + s[0, 2] * load[2] + s[0, 3] * load[3])
    return aside, by * (s[1, 0] * load[0] + s[1, 1] * load[1] + s[1, 2] * load[2] + s[1, 3] * load[3])


@compiled
def slip_of(hull, course, R_0, share, pitching, yawing, unknown):
    """Slip aside and up, a pair [rad], at which hull and fins make what is missing.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        course: record of `cube_sim.control.course_keeping.COURSE`.
        R_0: axes (3,3) of the course.
        share: of the speed through the water in that of the path.
        pitching: rate about y [rad/s].
        yawing: about z [rad/s].
        unknown: wrench (6-tuple) that the model does not explain [N, N m], body axes.
    """
    c, h, up = course[0], hull[0], (R_0[2, 0], R_0[2, 1], R_0[2, 2])
    lifted, righted = to_world(h.hydrostatics, up), to_world(h.hydrostatics[3:], up)
    t = c.turning
    load = (
        share * (t[0, 0] * pitching + t[0, 1] * yawing) - lifted[1] - unknown[1],
        share * (t[1, 0] * pitching + t[1, 1] * yawing) - lifted[2] - unknown[2],
        share * (t[2, 0] * pitching + t[2, 1] * yawing) - righted[1] - unknown[4],
        share * (t[3, 0] * pitching + t[3, 1] * yawing) - righted[2] - unknown[5],
    )
    aside, upward = slip_under(course, 1.0 / (share * share * c.speed), load)
    most = c.most_slip
    return min(max(aside, -most[0]), most[0]), min(max(upward, -most[1]), most[1])
