"""The law for all axes, from the desired motion and attitude to the wrench, compiled.

What it is told and what it remembers are records; `cube_sim.control.path_follower` holds them.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.loops import loop_wrench
from cube_sim.control.oscillation_centre import levelled_turning
from cube_sim.control.pace import (
    LEAST_PACE,
    RESERVE,
    PaceDemand,
    in_range,
    is_allowed,
    largest_share,
    share_while_it_helps,
    wrench_at_pace,
)
from cube_sim.control.shortage import PATIENCE_S
from cube_sim.guidance.view_record import path_turning
from cube_sim.native.compiled import compiled
from cube_sim.tuples import (
    cross_tuples,
    dot,
    length,
    minus,
    minus6,
    plus,
    plus6,
    rotated,
    sextuple,
    stacked,
    times,
    to_body,
    to_world,
    triple,
    turn_between,
)
from cube_sim.vehicle.laws.hull_motion import hull_damping, inverse_dynamics, steady_wrench

MOST_TURN_RAD = 0.3
"""The momentum of the attitude wanted is looked at for turns up to this one (a choice): farther off it says little of
what comes next."""
SLOW_M_S = 0.03
"""It counts half at this speed through the water (a choice). Slower, the course turns faster than a hull follows."""
STEERAGE_WAY = 0.7
"""Share of the speed wanted at which fins, half as strong, still steer (a choice)."""

FOLLOWED = np.dtype(
    [
        ("wrench", np.float64, 6),
        ("velocity", np.float64, 3),
        ("rates", np.float64, 3),
        ("attitude_error", np.float64),
        ("pace", np.float64),
        ("enough", np.bool_),
    ]
)
"""The answer: the wrench [N, N m] in the range of A, the velocity [m/s] and rates [rad/s] followed, all in body axes,
the angle of the attitude error [rad], the pace, and whether the thrusters have enough for the least pace."""


@compiled
def follow(
    hull,
    loops,
    left,
    normals,
    bounds,
    held_shares,
    memory,
    answer,
    R,
    q,
    v,
    w,
    velocity_W,
    acceleration_W,
    desired,
    disturbance,
    current_W,
    view,
    applied,
    force_ratio,
    most_rest,
    budgeted,
    waits,
    least_closing,
    points,
    short_s,
):
    """One tick of the law.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        loops: record of `cube_sim.control.loops.LOOPS`.
        left: record of `cube_sim.control.authority.CAPABILITY`.
        normals: of `ForceBudget`, like the next two; empty for none.
        bounds: of it.
        held_shares: of it.
        memory: record of `cube_sim.control.asked.MEMORY`, moved on.
        answer: record `FOLLOWED`, filled.
        R: R_WB (3,3).
        q: the same attitude (4,).
        v: over ground (3,) [m/s], body axes.
        w: (3,) [rad/s], body axes.
        velocity_W: desired (3,) [m/s], world axes.
        acceleration_W: desired (3,) [m/s^2], world axes.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`.
        disturbance: estimate (6,) [N, N m], body axes.
        current_W: estimate (3,) [m/s], world axes.
        view: record of `cube_sim.guidance.view_record.VIEW`; a target that stands still has no speed.
        applied: wrench (6,) allocated over the tick before.
        force_ratio: share of their force that the supply leaves the thrusters.
        most_rest: how much of a force and of a torque that could not be made is asked for again (2,) [N, N m].
        budgeted: whether what the thrusters can make is known.
        waits: whether the speed along the path falls to what they can keep.
        least_closing: share to which the speed across the path may fall for the same reason; 1 where it is not to.
        points: whether a balanced attitude reads the torque of the turning.
        short_s: for how long the thrusters have been short of what the least pace asks for [s].
    """
    m, k, out = memory[0], loops[0], answer[0]
    rates, speed, flow = triple(w), triple(v), triple(current_W)
    unknown = sextuple(disturbance)
    wanted = desired[0].quaternion
    quaternion, wanted_attitude = (q[0], q[1], q[2], q[3]), (wanted[0], wanted[1], wanted[2], wanted[3])
    velocity, wanted_rates = triple(velocity_W), triple(desired[0].rates)
    acceleration = triple(acceleration_W)
    tau, v_ref, w_ref, angle = loop_wrench(
        hull, loops, R, quaternion, speed, rates, velocity, acceleration, wanted_attitude, wanted_rates, flow
    )
    turning, frame = path_turning(view), view[0].frame
    pace, enough = 1.0, True
    pointed = minus6(tau, unknown)
    if budgeted:
        along_velocity, along_acceleration = along_path(frame, turning, velocity, acceleration)
        if least_closing < 1.0:
            # Faster across the path than along it as far as the thrusters have something left.
            across, dacross = minus(velocity, along_velocity), minus(acceleration, along_acceleration)
            demand = pace_demand(hull, R, k.velocity_time, v_ref, flow, across, dacross, pointed, unknown)
            closing = largest_share(hull, left, normals, bounds, held_shares, force_ratio, demand, least_closing)
            if closing < 1.0:
                velocity = plus(velocity, times(max(closing, least_closing) - 1.0, across))
                acceleration = plus(acceleration, times(max(closing, least_closing) - 1.0, dacross))
                tau, v_ref, w_ref, angle = loop_wrench(
                    hull,
                    loops,
                    R,
                    quaternion,
                    speed,
                    rates,
                    velocity,
                    acceleration,
                    wanted_attitude,
                    wanted_rates,
                    flow,
                )
                pointed = minus6(tau, unknown)
        demand = pace_demand(
            hull, R, k.velocity_time, v_ref, flow, along_velocity, along_acceleration, pointed, unknown
        )
        if waits:
            if left[0].by_momentum:
                pace = share_while_it_helps(hull, left, normals, bounds, held_shares, force_ratio, demand)
            else:
                pace = largest_share(hull, left, normals, bounds, held_shares, force_ratio, demand, -1.0)
            if pace < -1.0 and short_s > PATIENCE_S:
                # Nothing would be gained by standing: what is kept for errors goes into the pace, or it is the least.
                all_force = force_ratio / (1.0 - RESERVE)
                pace = largest_share(hull, left, normals, bounds, held_shares, all_force, demand, 0.0)
                pace = max(pace, LEAST_PACE)
            pace = 0.0 if pace < -1.0 else pace
        if pace < 1.0:
            velocity = plus(velocity, times(pace - 1.0, along_velocity))
            acceleration = plus(acceleration, times(pace - 1.0, along_acceleration))
            tau, v_ref, w_ref, angle = loop_wrench(
                hull, loops, R, quaternion, speed, rates, velocity, acceleration, wanted_attitude, wanted_rates, flow
            )
        pointed = wrench_at_pace(hull, demand, max(pace, LEAST_PACE))
        enough = is_allowed(normals, bounds, held_shares, force_ratio, in_range(left, pointed))
    with_path = to_body(R, levelled_turning(frame, turning))
    own = own_turning(hull, R, speed, rates, with_path, flow)
    force = to_world(R, minus(pointed[:3], own))
    if points and left[0].by_momentum:
        course = minus(velocity, flow)
        gained = momentum_to_gain(hull, R, turn_between(quaternion, wanted_attitude), course)
        counts = dot(course, course) / (dot(course, course) + SLOW_M_S**2)
        force = plus(force, times(counts / k.velocity_time, gained))
    rest = unmade(m.asked, m.has_asked, applied, most_rest)
    if left[0].by_flow:
        tau = with_way_on(hull, k.velocity_time, tau, minus(speed, to_body(R, flow)), minus(velocity, flow))
    asked = in_range(left, plus6(minus6(tau, unknown), rest))
    torque = (0.0, 0.0, 0.0)
    if points:
        torque = turning_torque(hull, R, speed, with_path, flow)
    m.has_asked = True
    for i in range(3):
        m.force[i], m.velocity[i] = force[i], velocity[i]
        m.torque[i] = torque[i] - unknown[3 + i]
        out.velocity[i], out.rates[i] = v_ref[i], w_ref[i]
    for i in range(6):
        m.asked[i] = out.wrench[i] = asked[i]
    out.attitude_error, out.pace, out.enough = angle, pace, enough


@compiled
def with_way_on(hull, velocity_time, tau, flow, wanted_W):
    """A wrench (6-tuple) [N, N m], pushed ahead where the hull would lose the way on by which its fins steer it.

    It has to turn before it can go where it is to go, and without way on it cannot turn: so it goes on ahead at
    `STEERAGE_WAY` of the speed wanted, wherever its nose points. Faster than that nothing is changed.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        velocity_time: of its loop [s].
        tau: the wrench wanted.
        flow: velocity through the water, a 3-tuple [m/s], body axes.
        wanted_W: that wanted, a 3-tuple [m/s], world axes.
    """
    way = STEERAGE_WAY * length(wanted_W)
    ahead = hull_damping(hull, (way, 0.0, 0.0, 0.0, 0.0, 0.0))[0]
    ahead += hull[0].total_mass[0, 0] / velocity_time * (way - flow[0])
    return (max(tau[0], ahead), tau[1], tau[2], tau[3], tau[4], tau[5])


@compiled
def along_path(frame, turning, velocity, acceleration):
    """The part of a motion along the path, velocity and acceleration (3-tuples); it turns with the path frame."""
    T = (frame[0, 0], frame[1, 0], frame[2, 0])
    along = times(dot(velocity, T), T)
    return along, plus(times(dot(acceleration, T), T), cross_tuples(turning, along))


@compiled
def pace_demand(hull, R, velocity_time, v_ref, flow_W, along_velocity, along_acceleration, demanded, unknown):
    """What a pace along the path asks for, with the torque that holds the attitude (`PaceDemand`)."""
    along, flow = to_body(R, along_velocity), minus(v_ref, to_body(R, flow_W))
    pull = plus(times(1.0 / velocity_time, along), to_body(R, along_acceleration))
    up = (R[2, 0], R[2, 1], R[2, 2])
    rest = minus(demanded[:3], steady_wrench(hull, flow, up)[:3])
    push = to_world(hull[0].total_mass, pull)
    return PaceDemand(flow, along, push, stacked(rest, times(-1.0, unknown[3:])), up)


@compiled
def as_it_turns(hull, R, speed, rates, flow_W):
    """The wrench (6-tuple), body axes, of the velocity the hull has over ground, kept while it turns at these rates."""
    kept = stacked(times(-1.0, cross_tuples(rates, speed)), (0.0, 0.0, 0.0))
    return inverse_dynamics(hull, R, stacked(speed, rates), kept, flow_W)


@compiled
def own_turning(hull, R, speed, rates, along, flow_W):
    """The force (3-tuple) [N], body axes, that the hull asks for as it turns otherwise than along its path.

    An attitude that points it would chase itself: added mass makes that force grow with the turning, not the path.
    """
    return minus(as_it_turns(hull, R, speed, rates, flow_W)[:3], as_it_turns(hull, R, speed, along, flow_W)[:3])


@compiled
def momentum_to_gain(hull, R, turn, flow_W):
    """By how much the momentum of a velocity through the water is another once the hull has turned, a 3-tuple [N s].

    More added mass aside than ahead makes a hull slip as it turns: its momentum stays, its velocity does not. A force
    against that slip, pointed by a turn, would chase itself. So what the velocity loop asks for, M (v_d - v) / T, is
    pointed as a correction of the momentum, (M_d v_d - M v) / T, with the mass M_d of the attitude wanted.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        R: R_WB (3,3).
        turn: to the attitude wanted, a 3-tuple [rad], body axes.
        flow_W: the velocity wanted through the water, a 3-tuple [m/s], world axes.
    """
    angle, M = length(turn), hull[0].total_mass
    if angle == 0.0:
        return (0.0, 0.0, 0.0)
    turned = rotated(R, times(1.0 / angle, turn), min(angle, MOST_TURN_RAD))
    then = to_world(turned, to_world(M, to_body(turned, flow_W)))
    return minus(then, to_world(R, to_world(M, to_body(R, flow_W))))


@compiled
def turning_torque(hull, R, speed, along, flow_W):
    """The torque (3-tuple) [N m], body axes, that the hull asks for as it turns along its path."""
    straight_on = as_it_turns(hull, R, speed, (0.0, 0.0, 0.0), flow_W)
    return minus(as_it_turns(hull, R, speed, along, flow_W)[3:], straight_on[3:])


@compiled
def unmade(asked, has_asked, applied, most_rest):
    """What was not made of the last demand (6-tuple), bounded: what a dead zone swallows is asked for again.

    The torque is bounded by itself, too: where the force is made in full, and it is not, it would wind up.
    """
    if not has_asked:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    rest = minus6(sextuple(asked), sextuple(applied))
    share = min(1.0, most_rest[0] / max(length(rest[:3]), 1e-12))
    of_torque = min(share, most_rest[1] / max(length(rest[3:]), 1e-12))
    return stacked(times(share, rest[:3]), times(of_torque, rest[3:]))
