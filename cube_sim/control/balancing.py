"""The turning rate of a balanced attitude, compiled; the law is said in `cube_sim.control.balanced_attitude`."""

from __future__ import annotations

from math import acos, sqrt

import numpy as np

from cube_sim.control.course_wish import wish_for_trim
from cube_sim.control.damped_inverse import damped_inverse
from cube_sim.control.oscillation_centre import levelled_turning
from cube_sim.control.pace import facet_excess
from cube_sim.control.turning_on import turn_on
from cube_sim.guidance.view_record import path_turning
from cube_sim.native.compiled import compiled
from cube_sim.tuples import (
    cross_tuples,
    dot,
    length,
    minus,
    plus,
    plus6,
    put_matrix,
    quaternion_from_matrix,
    quaternion_times,
    rotated,
    stacked,
    times,
    to_body,
    to_world,
    triple,
    turn_between,
)
from cube_sim.vehicle.laws.hull_motion import steady_wrench, steady_wrench_slope, turning_slope

SOFTNESS_N, SOFT_SHARE = 0.6, 0.012
"""Damping of the inverse: forces of this size and less hardly turn the vehicle, as their direction means little; of
a vehicle with small thrusters, of this share of what the strongest makes (choices)."""
YIELDING = 1.0 / 6.0
"""The same for what the mission wishes, as a share of it: down to this it gives way to the balance. As soft as the
balance itself, half of a pull gets past it at such a force, and the hull stands beside its path, turned to the wished
side."""
SHORTAGE_TIME = 2.0
"""Over which the force that is compared with what is attainable is averaged, and in which the vehicle turns [s]."""
LEAST_TWIST = 1e-3
"""Cosine of half the tilt below which the turn about z means nothing: upside down."""
MOST_PULL_RAD = 0.3
"""A nose that points farther from where the mission wishes, or a hull that is tilted farther, is pulled there no more
than from so far (a choice). The inverse is damped, so that some of a pull gets past the first task: a strong one would
swing the hull about its balance."""
FARTHEST_RAD = 0.7
"""A hull that is this far from the attitude found, and comes no nearer, is held by its water elsewhere: the search goes
on from there. One that is as far from its wish when the search begins turns to that first."""
WATCHED = 4.0
"""How many times the time of the first task a hull that is far is watched for whether it comes nearer (a choice)."""
NEARER = 0.95
"""Share of what an angle was, on the average of that time, below which it has become smaller."""
NEVER_SEEN_RAD = 2.0 * np.pi
"""Farther than any attitude: what an angle was before the first tick."""

BALANCE = np.dtype(
    [
        ("lost", np.float64, (6, 6)),
        ("constants", np.float64, 6),
        ("count", np.int64),
        ("level", np.bool_),
        ("time", np.float64),
        ("softness", np.float64),
        ("wish_time", np.float64),
        ("most_rate", np.float64),
        ("most_roll", np.float64),
        ("watched", np.bool_),
        ("trimmed", np.bool_),
        ("trim", np.float64, (3, 3)),
        ("judged_wish", np.float64, (3, 3)),
        ("judged_speed", np.float64),
        ("judged_climb", np.float64),
    ]
)
"""Numbers of `BalancedAttitude`: N (6, count) and b (count,) of the lost combinations, the rest of zeros; whether it
turns in a level plane only; the times [s], the damping of the inverse [N], the bounds of its rate [rad/s] and of the
sine of its roll, up to which it rolls to point a force. Whether its wish is judged by the trims of the course, and
whether it wishes for one of them instead, `trim`; the wish, in the axes of the course, the speed [m/s] and the angle
above the horizontal [rad] that were judged."""
MEMORY = np.dtype(
    [
        ("rotation", np.float64, (3, 3)),
        ("led", np.float64, (2, 3)),
        ("twice", np.float64, (2, 3)),
        ("slow", np.float64, (2, 3)),
        ("torque", np.float64, 3),
        ("torque_twice", np.float64, 3),
        ("change", np.float64, (2, 3)),
        ("torque_change", np.float64, 3),
        ("started", np.bool_),
        ("short", np.bool_),
        ("off", np.float64),
        ("astray", np.float64),
        ("heading", np.float64, 2),
        ("course_wish", np.float64, (3, 3)),
        ("speed", np.float64),
        ("climb", np.float64),
        ("since", np.float64),
        ("stale", np.bool_),
    ]
)
"""What it remembers: R, the averages of U and F_W (once, twice, over the time of a shortage), those of M_0, the
derivatives of U, F_W and M_0 as led, whether there was a tick before, whether W exceeds what is attainable, how far R
is from the wish and how far the hull was from R, averaged [rad]. Of the course through the water its horizontal
direction, the mission's wish in its axes, its speed [m/s] and angle above the horizontal [rad], for how long they are
judged [s], and whether they have become others since."""


@compiled
def balance(
    hull,
    parameters,
    normals,
    bounds,
    held_shares,
    memory,
    desired,
    view,
    R_now,
    asked,
    current_W,
    dt,
    force_ratio,
):
    """One tick: the desired attitude, and R moved on.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        parameters: record `BALANCE`.
        normals: of `ForceBudget`, like the next two; empty for none.
        bounds: of it.
        held_shares: of it.
        memory: record `MEMORY`, moved on.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`: what the mission asks for, then what is found.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        R_now: R_WB (3,3) of the hull.
        asked: record of `cube_sim.control.asked.MEMORY`: velocity, force and torque of the tick before.
        current_W: (3,) [m/s], world axes.
        dt: [s].
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    p, m, out, before = parameters[0], memory[0], desired[0], asked[0]
    if p.watched:
        wish_for_trim(p, m, out, view, R_now, length(triple(before.velocity)), current_W, dt)
    flow_W = minus(triple(before.velocity), triple(current_W))
    flow, up = to_body(R_now, flow_W), (R_now[2, 0], R_now[2, 1], R_now[2, 2])
    steady = to_world(R_now, steady_wrench(hull, flow, up)[:3])
    if not m.started:
        _begin(m, R_now, out.quaternion)
    turning = path_turning(view)
    with_path = levelled_turning(view[0].frame, turning)
    _turn_along(m.slow, turning, dt)
    _turn_along(m.led, with_path, dt)
    _turn_along(m.twice, with_path, dt)
    # What was asked for the tick before has turned on with the path since.
    now, rest = _turned(flow_W, with_path, dt), _turned(minus(triple(before.force), steady), with_path, dt)
    _average(m, now, rest, triple(before.torque), with_path, dt, p.time)
    if _held_elsewhere(m, _angle_between(m.rotation, R_now), min(1.0, dt / (WATCHED * p.time))):
        put_matrix(m.rotation, R_now)
    R = m.rotation
    rates = _rates(hull, p, normals, bounds, held_shares, m, R, desired, force_ratio)
    turn_on(R, desired, rates, p.most_rate, dt)


@compiled
def _begin(m, R_now, wish):
    """Begin the search at what the mission wishes (4,) where the hull is far from it.

    A slender hull is balanced stern first, too, and from abeam that may be the nearer way.
    """
    turn = turn_between(quaternion_from_matrix(R_now), (wish[0], wish[1], wish[2], wish[3]))
    angle = length(turn)
    if angle > FARTHEST_RAD:
        put_matrix(m.rotation, rotated(R_now, times(1.0 / angle, turn), angle))


@compiled
def _held_elsewhere(m, far, share):
    """Whether the hull, so far from R [rad], is far and comes no nearer; share of the time watched that has passed."""
    m.astray += share * (far - m.astray)
    return far > FARTHEST_RAD and far > NEARER * m.astray


@compiled
def _turned(vector, turning_W, dt):
    """A vector (3-tuple) a tick later that turns at a rate (3-tuple) [rad/s]."""
    return plus(vector, times(dt, cross_tuples(turning_W, vector)))


@compiled
def _turn_along(averages, turning_W, dt):
    """Turn averages (2,3) as the path turns (3-tuple) [rad/s].

    Those over the time of a shortage have no lead. Left behind by a turning path, they would tell of a slip that the
    hull does not have, and of the Munk moment that this slip would ask the thrusters for. Those that are led would be
    so only for a force that changes evenly: one that turns at w comes out too large by (w T)^2.
    """
    for k in range(2):
        turned = _turned(triple(averages[k]), turning_W, dt)
        for i in range(3):
            averages[k, i] = turned[i]


@compiled
def _average(m, flow_W, force, torque, turning_W, dt, time):
    """Move the averages on by what is demanded now; they have been turned along with the path (3-tuple) [rad/s]."""
    share, slow_share = min(1.0, dt / time), min(1.0, dt / SHORTAGE_TIME)
    for i in range(3):
        if not m.started:
            m.led[0, i] = m.twice[0, i] = m.slow[0, i] = flow_W[i]
            m.led[1, i] = m.twice[1, i] = m.slow[1, i] = force[i]
            m.torque[i] = m.torque_twice[i] = torque[i]
        for j in range(2):
            now = flow_W[i] if j == 0 else force[i]
            m.change[j, i] = (2.0 * (now - m.led[j, i]) - (m.led[j, i] - m.twice[j, i])) / time
        m.torque_change[i] = (2.0 * (torque[i] - m.torque[i]) - (m.torque[i] - m.torque_twice[i])) / time
        m.led[0, i] += share * (flow_W[i] - m.led[0, i])
        m.led[1, i] += share * (force[i] - m.led[1, i])
        m.slow[0, i] += slow_share * (flow_W[i] - m.slow[0, i])
        m.slow[1, i] += slow_share * (force[i] - m.slow[1, i])
        m.torque[i] += share * (torque[i] - m.torque[i])
        m.torque_twice[i] += share * (m.torque[i] - m.torque_twice[i])
        for j in range(2):
            m.twice[j, i] += share * (m.led[j, i] - m.twice[j, i])
    for j in range(2):
        turned = cross_tuples(turning_W, minus(times(2.0, triple(m.led[j])), triple(m.twice[j])))
        for i in range(3):
            m.change[j, i] += turned[i]
    m.started = True


@compiled
def _rates(hull, p, normals, bounds, held_shares, m, R, desired, force_ratio):
    """Turning rate, a 3-tuple [rad/s], body axes."""
    z = (R[2, 0], R[2, 1], R[2, 2])
    flow, force, flow_change, force_change = _led(m, R)
    nu = np.array((flow[0], flow[1], flow[2], 0.0, 0.0, 0.0))
    by_velocity = steady_wrench_slope(hull, nu, np.zeros(6))
    turning = turning_slope(hull, by_velocity, flow, force, z)
    torque_change = triple(m.torque_change)
    torque = minus(times(2.0, triple(m.torque)), triple(m.torque_twice))
    wrench = plus6(steady_wrench(hull, flow, z), stacked(force, torque))
    J, imbalance, rows = np.empty((7, 3)), np.empty(7), p.count
    for k in range(rows):
        now, changing = -p.constants[k], 0.0
        J[k, 0] = J[k, 1] = J[k, 2] = 0.0
        for i in range(6):
            share = p.lost[i, k]
            change = by_velocity[i, 0] * flow_change[0] + by_velocity[i, 1] * flow_change[1]
            change += by_velocity[i, 2] * flow_change[2]
            change += force_change[i] if i < 3 else torque_change[i - 3]
            now += share * wrench[i]
            changing += share * change
            for j in range(3):
                J[k, j] += share * turning[i, j]
        imbalance[k] = now / p.time + changing
    m.short = False
    if len(bounds) > 0:
        slow_flow, slow_force = to_body(R, triple(m.slow[0])), to_body(R, triple(m.slow[1]))
        slow = plus6(steady_wrench(hull, slow_flow, z), stacked(slow_force, triple(m.torque)))
        worst, excess = _worst_facet(normals, bounds, held_shares, force_ratio, slow)
        if excess > 0.0:
            m.short = True
            for j in range(3):
                J[rows, j] = 0.0
                for i in range(6):
                    J[rows, j] += normals[worst, i] * turning[i, j]
            imbalance[rows] = excess / SHORTAGE_TIME
            rows += 1
    if p.level:  # it turns about the vertical only, and no other turn counts as a way out
        for k in range(rows):
            about = J[k, 0] * z[0] + J[k, 1] * z[1] + J[k, 2] * z[2]
            J[k, 0], J[k, 1], J[k, 2] = about * z[0], about * z[1], about * z[2]
    easily = max(0.0, 1.0 - (R[2, 1] / p.most_roll) * (R[2, 1] / p.most_roll))
    for k in range(rows):
        J[k, 0] *= easily
    second, against = _towards(m, R, desired, p.wish_time), np.empty(7)
    for k in range(rows):
        against[k] = J[k, 0] * second[0] + J[k, 1] * second[1] + J[k, 2] * second[2]
    second = minus(second, damped_inverse(J, against, rows, (YIELDING * p.softness) ** 2))
    rates = minus(second, damped_inverse(J, imbalance, rows, p.softness**2))
    return times(dot(z, rates), z) if p.level else rates


@compiled
def _led(m, R):
    """U, F_W as led, and the derivatives of these as the path turns: four 3-tuples in body axes."""
    flow = minus(times(2.0, triple(m.led[0])), triple(m.twice[0]))
    force = minus(times(2.0, triple(m.led[1])), triple(m.twice[1]))
    return to_body(R, flow), to_body(R, force), to_body(R, triple(m.change[0])), to_body(R, triple(m.change[1]))


@compiled
def _worst_facet(normals, bounds, held_shares, force_ratio, wrench):
    """Which facet of what is attainable a wrench (6-tuple) exceeds most, and by how much [N]."""
    worst, most = 0, -np.inf
    for i in range(len(bounds)):
        excess = facet_excess(normals, bounds, held_shares, force_ratio, i, wrench)
        if excess > most:
            worst, most = i, excess
    return worst, most


@compiled
def tilt_and_heading(q):
    """The way to an attitude q (4-tuple), a 3-tuple [rad]: how to tilt the body's z axis, and how to turn about it.

    q = swing twist, the twist about z. For small angles it is the vector part of q, twice. Where the nose points far
    from the wished one, tilting by that would go about the wrong axis; and the pull to that side, where balance forbids
    to give way to it, must not tilt the hull. Both are pulls of `MOST_PULL_RAD` at most.
    """
    w, x, y, z = q
    c = max(sqrt(w * w + z * z), LEAST_TWIST)
    about_x, about_y = 2.0 * (x * w - y * z) / c, 2.0 * (y * w + x * z) / c
    share = MOST_PULL_RAD / max(sqrt(about_x * about_x + about_y * about_y), MOST_PULL_RAD)
    return share * about_x, share * about_y, min(max(2.0 * z / c, -MOST_PULL_RAD), MOST_PULL_RAD)


@compiled
def _towards(m, R, desired, wish_time):
    """Turning rate, a 3-tuple [rad/s], body axes, to the attitude the mission asks for; how far it is off is kept."""
    q, wish = quaternion_from_matrix(R), desired[0].quaternion
    error = quaternion_times((q[0], -q[1], -q[2], -q[3]), (wish[0], wish[1], wish[2], wish[3]))
    if error[0] < 0.0:
        error = (-error[0], -error[1], -error[2], -error[3])
    m.off = 2.0 * length(error[1:])
    return plus(to_body(R, triple(desired[0].rates)), times(1.0 / wish_time, tilt_and_heading(error)))


@compiled
def _angle_between(a, b):
    """The angle of the rotation from one attitude (3,3) to another [rad]."""
    trace = 0.0
    for i in range(3):
        for j in range(3):
            trace += a[i, j] * b[i, j]
    return acos(min(max((trace - 1.0) / 2.0, -1.0), 1.0))
