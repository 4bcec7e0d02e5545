"""A control law of the user's own as compiled code asks it: its aim, its memory, its answer looked at."""

from __future__ import annotations

from functools import cache
from math import isfinite, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import PathPoint
from cube_sim.native.asking import WORD, ask_at
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, State, Vector
from cube_sim.tuples import length, minus, plus, put, put_matrix, stacked, to_body, to_world, triple, turn_between

ANSWERED, RAISED, NO_SIX, NOT_FINITE = range(4)
"""What came of asking: an answer; an exception; other than six numbers; or numbers that are not finite."""


class PlainAim(NamedTuple):
    """One tick of a compiled law: an `Aim` but for what its thrusters can do; body axes unless said otherwise.

    All arrays are the law's own, to be changed as it likes.

    Attributes:
        time: since the start [s].
        dt: length of a tick [s].
        state: the vehicle, as the controller knows it.
        target_view: the vehicle seen from its target on the path.
        error: (6,) [m, rad] from the vehicle to its target: the way there, and the rotation vector to the attitude
            wanted.
        velocity: (6,) wanted [m/s, rad/s], over ground.
        velocity_error: (6,) the velocity wanted less the actual one [m/s, rad/s].
        acceleration: (3,) derivative of the velocity wanted along the present motion [m/s^2], world axes.
        quaternion: q_WD (4,) wxyz, the attitude wanted.
        applied: (6,) [N, N m] the wrench allocated over the tick before.
        force_ratio: share of their force that the supply leaves the thrusters.
    """

    time: float
    dt: float
    state: State
    target_view: TargetView
    error: Vector
    velocity: Vector
    velocity_error: Vector
    acceleration: Vector
    quaternion: Vector
    applied: Vector
    force_ratio: float


class OwnLawParts(NamedTuple):
    """What a compiled law of the user's own is asked with.

    Attributes:
        code: address of the law; 0 for none.
        in_parts: whether it answers a primary and a secondary part.
        ticks: (1,) how often it has answered, counted on.
        parameters: (k,) of `WORD`.
        memory: (n,) of `WORD`, moved on.
        words: (n,) the same memory in numbers.
        kept: (n,) scratch.
        secondary: (6,) out: the part that gives way [N, N m].
    """

    code: int
    in_parts: bool
    ticks: NDArray[np.int64]
    parameters: Record
    memory: Record
    words: Vector
    kept: Vector
    secondary: Vector


@cache
def no_own_law() -> OwnLawParts:
    """For a flight by a law of cube_sim's."""
    return OwnLawParts(
        0, False, np.zeros(1, np.int64), np.zeros(1, WORD), np.zeros(1, WORD), np.zeros(1), np.zeros(1), np.zeros(6)
    )


def still_aim() -> PlainAim:
    """One of the right types."""
    point = PathPoint(np.zeros(3), np.eye(3), (0.0, 0.0), (0.0, 0.0))
    view = TargetView(0.0, 0.0, 0.0, point, np.zeros(3), np.zeros(3))
    state = State(np.zeros(3), np.zeros(4), np.eye(3), np.zeros(3), np.zeros(3))
    six = np.zeros(6), np.zeros(6), np.zeros(6)
    return PlainAim(0.0, 0.0, state, view, *six, np.zeros(3), np.zeros(4), np.zeros(6), 1.0)


@compiled
def copied(a):
    """An array (n,) once more."""
    copy = np.empty(len(a))
    put(copy, a)
    return copy


@compiled
def copied_matrix(M):
    """A matrix once more."""
    copy = np.empty(M.shape)
    put_matrix(copy, M)
    return copy


@compiled
def plain_aim(ticks, view, desired, R, q, v, w, velocity_W, acceleration_W, applied, dt, force_ratio):
    """The aim of a tick.

    Args:
        ticks: how many there were before.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        desired: record of `cube_sim.control.attitude_mode.DESIRED`.
        R: R_WB (3,3).
        q: the same attitude (4,).
        v: over ground (3,) [m/s], body axes.
        w: (3,) [rad/s], body axes.
        velocity_W: wanted (3,) [m/s], over ground, world axes.
        acceleration_W: its derivative (3,) [m/s^2].
        applied: wrench (6,) allocated over the tick before.
        dt: [s].
        force_ratio: share of their force that the supply leaves the thrusters.
    """
    seen, wanted = view[0], desired[0].quaternion
    away_W = to_world(seen.frame, triple(seen.error))
    position = plus((seen.row[0], seen.row[1], seen.row[2]), away_W)
    bending, rate = (seen.row[12], seen.row[13]), (seen.row[14], seen.row[15])
    point = PathPoint(copied(seen.row[:3]), copied_matrix(seen.frame), bending, rate)
    way, turn = to_body(R, away_W), turn_between((q[0], q[1], q[2], q[3]), (wanted[0], wanted[1], wanted[2], wanted[3]))
    velocity, rates = to_body(R, triple(velocity_W)), to_body(R, triple(desired[0].rates))
    return PlainAim(
        ticks * dt,
        dt,
        State(np.array(position), copied(q), copied_matrix(R), copied(v), copied(w)),
        TargetView(seen.arc_length, seen.remaining, seen.speed, point, copied(seen.error), copied(seen.velocity)),
        np.array(stacked((-way[0], -way[1], -way[2]), turn)),
        np.array(stacked(velocity, rates)),
        np.array(stacked(minus(velocity, triple(v)), minus(rates, triple(w)))),
        copied(acceleration_W),
        copied(wanted),
        copied(applied),
        force_ratio,
    )


@compiled
def ask(own, asked, view, desired, followed, R, q, v, w, velocity_W, acceleration_W, applied, dt, force_ratio):
    """Ask the law for its wrench.

    Args:
        own: `OwnLawParts`; its memory moves on where there is an answer.
        asked: record of `cube_sim.control.asked.MEMORY`, moved on.
        view: as in `plain_aim`, like all that follow but one.
        desired: see there.
        followed: record of `cube_sim.control.following.FOLLOWED`, filled; its wrench is NaN where there is no answer.
        R: see there.
        q: see there.
        v: see there.
        w: see there.
        velocity_W: see there.
        acceleration_W: see there.
        applied: see there.
        dt: see there.
        force_ratio: see there.

    Returns:
        `ANSWERED`, or what there is in place of an answer.
    """
    aim = plain_aim(own.ticks[0], view, desired, R, q, v, w, velocity_W, acceleration_W, applied, dt, force_ratio)
    out, a = followed[0], asked[0]
    for i in range(3):
        out.velocity[i], out.rates[i] = aim.velocity[i], aim.velocity[3 + i]
    out.attitude_error, out.pace, out.enough = length((aim.error[3], aim.error[4], aim.error[5])), 1.0, True
    put(own.kept, own.words)
    told = aim, own.parameters[0], own.memory[0]
    state = ANSWERED
    if own.in_parts:
        has, (primary, secondary) = ask_at((own.secondary, own.secondary), own.code, told)
        if not has:
            state = RAISED
        elif len(primary) != 6 or len(secondary) != 6:
            state = NO_SIX
        else:
            for i in range(6):
                out.wrench[i], own.secondary[i] = primary[i] + secondary[i], secondary[i]
    else:
        has, wrench = ask_at(own.secondary, own.code, told)
        if not has:
            state = RAISED
        elif len(wrench) != 6:
            state = NO_SIX
        else:
            put(out.wrench, wrench)
    if state == ANSWERED and not isfinite(out.wrench.sum() + own.secondary.sum()):
        state = NOT_FINITE
    if state != ANSWERED:
        put(own.words, own.kept)
        for i in range(6):
            out.wrench[i] = nan
        return state
    own.ticks[0] += 1
    force = to_world(R, (out.wrench[0], out.wrench[1], out.wrench[2]))
    for i in range(3):
        a.force[i], a.torque[i], a.velocity[i] = force[i], out.wrench[3 + i], velocity_W[i]
    return state
