"""The filter's law, compiled: strapdown prediction, readings fused at the instant they speak of, a gate."""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled, inlined
from cube_sim.navigation.aid import DEPTH, DVL, HEADING, POSITION
from cube_sim.navigation.correction import corrected
from cube_sim.navigation.expectation import difference, expect
from cube_sim.navigation.gate import (
    AGREEMENT,
    DOUBTED_SPEED,
    DOUBTED_TILT,
    FASTEST,
    FREE_FALL,
    MAX_REJECTIONS,
    MOST_DOUBTS,
    UNKNOWN_ACCELERATION,
    UNKNOWN_RATE,
)
from cube_sim.navigation.imu import INERTIAL
from cube_sim.navigation.reading import ACCEPTED_AFTER_REJECTIONS, ARRIVED, FUSED, NONE, REJECTED
from cube_sim.navigation.strapdown import predict, rotation
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.tuples import triple

FILTER = np.dtype(
    [("period_s", np.float64), ("gravity", np.float64, 3), ("noise", np.float64, 6), ("walk", np.float64, 6)]
)
"""Length of a tick [s], gravity [m/s^2] in world axes, the stated densities of the inertial unit's noise and walks."""


class FilterMemory(NamedTuple):
    """The estimate, and what is remembered of the last N ticks: tick t in row t % N.

    Attributes:
        tick: the present one (1,), -1 before the first.
        x: (16 + c,) state, laid out as in `cube_sim.navigation.strapdown`.
        P: (15 + c, 15 + c) covariance of its error.
        rejections: readings of each sensor rejected in a row that agree (k,).
        rejected: innovation of the last of them (k, 3).
        inertials: (N, 9) readings of the inertial unit.
        states: (N, 16 + c) of each tick before its readings.
        covariances: (N, 15 + c, 15 + c) likewise.
        rejections_before: (N, k) likewise.
        rejected_before: (N, k, 3) likewise.
        readings: (N, k) of `cube_sim.navigation.reading.READING`, in the row of the tick at which they were taken.
    """

    tick: NDArray[np.int64]
    x: Vector
    P: Matrix
    rejections: NDArray[np.int64]
    rejected: Matrix
    inertials: Matrix
    states: Matrix
    covariances: NDArray[np.float64]
    rejections_before: NDArray[np.int64]
    rejected_before: NDArray[np.float64]
    readings: Record


@compiled
def set_estimate(x, P, state, covariance):
    """Copy a state and its covariance into x and P."""
    for i in range(len(x)):
        x[i] = state[i]
    for i in range(len(P)):
        for j in range(len(P)):
            P[i, j] = covariance[i, j]


@inlined
def remember(memory, at):
    """Write the estimate into a row, as that of its tick before any reading."""
    set_estimate(memory.states[at], memory.covariances[at], memory.x, memory.P)
    for i in range(len(memory.rejections)):
        memory.rejections_before[at, i] = memory.rejections[i]
        for j in range(3):
            memory.rejected_before[at, i, j] = memory.rejected[i, j]


@inlined
def recall(memory, at):
    """Take up the estimate of a row."""
    set_estimate(memory.x, memory.P, memory.states[at], memory.covariances[at])
    for i in range(len(memory.rejections)):
        memory.rejections[i] = memory.rejections_before[at, i]
        for j in range(3):
            memory.rejected[i, j] = memory.rejected_before[at, i, j]


@inlined
def estimated_constants(aid, x):
    """The constant errors of a sensor as the state x has them, a 4-tuple; zeros for those it does not have."""
    at, c = aid.place + 1, aid.constants
    return (
        x[at] if c > 0 else 0.0,
        x[at + 1] if c > 1 else 0.0,
        x[at + 2] if c > 2 else 0.0,
        x[at + 3] if c > 3 else 0.0,
    )


@inlined
def doubted(kind, i):
    """The standard deviation to which a sensor that contradicts the estimate lets component i of its error rise.

    Infinite for what the sensor reads: there the reading itself says how far. 0 for what it cannot see, and for the
    sensors' own errors: a filter that is lost would otherwise explain its being lost by them. In between for what the
    quantity read grows out of: it may be the cause, but a jump in one is no measurement of the other.
    """
    if kind == DEPTH:
        return inf if i == 2 else 0.0
    if kind == HEADING:
        return inf if i == 8 else DOUBTED_TILT if i > 5 else 0.0
    if i < 3:
        return 0.0 if kind == DVL else inf
    if i < 6:
        return DOUBTED_SPEED if kind == POSITION else inf
    if i < 9:
        return DOUBTED_TILT if kind in (DVL, POSITION) else 1.0
    return 0.0


@inlined
def inflated(kind, P, factor):
    """The covariance of an estimate doubted for a sensor, a new array: D P D, which keeps it one.

    D raises the variances by a factor, none beyond `doubted`. How motion and the sensors' own errors go together was
    learnt from what is now in doubt, and is forgotten: a jump of the motion would else be shared with those errors.
    """
    size, scale = len(P), sqrt(factor)
    raised, scales = P.copy(), np.ones(size)
    for i in range(9):
        scales[i] = max(1.0, min(scale, doubted(kind, i) / sqrt(P[i, i]))) if P[i, i] > 0.0 else 1.0
    for i in range(size):
        for j in range(size):
            raised[i, j] *= scales[i] * scales[j] if (i < 9) == (j < 9) else 0.0
    return raised


@inlined
def agrees(aid, y, last, speed):
    """Whether two innovations of a sensor, (n,) and (n,) or more, say the same.

    Those of a place change from one reading to the next by no more than a vehicle can have gone that is as fast as any
    and estimated to move at a speed [m/s], beside the noise of both.
    """
    apart, this, other = 0.0, 0.0, 0.0
    for i in range(aid.components):
        apart += difference(aid, y[i], last[i]) ** 2
        this += y[i] ** 2
        other += last[i] ** 2
    gone = inf
    if aid.kind == DEPTH or aid.kind == POSITION:
        gone = (FASTEST + speed) / aid.rate_hz + 6.0 * sqrt(2.0) * aid.noise
    return apart <= min(AGREEMENT**2 * max(this, other), gone**2)


@inlined
def hold_speed(x):
    """Shorten a velocity faster than any vehicle's."""
    fast = sqrt(x[3] ** 2 + x[4] ** 2 + x[5] ** 2)
    if fast > FASTEST:
        for i in range(3, 6):
            x[i] *= FASTEST / fast


@compiled
def fuse(aid, memory, reading, inertial):
    """Fuse a reading of the estimate's own tick, unless the gate rejects it.

    Args:
        aid: element of `cube_sim.navigation.aid.AID`.
        memory: `FilterMemory`; x, P and rejections are moved on.
        reading: element of `cube_sim.navigation.reading.READING`; innovation, NIS and outcome are filled.
        inertial: (9,) reading of the inertial unit at that tick.
    """
    x, n, size = memory.x, aid.components, len(memory.P)
    expected, H_motion, H_constants = np.empty(3), np.empty((3, 12)), np.empty((3, 4))
    w = (inertial[6] - x[10], inertial[7] - x[11], inertial[8] - x[12])
    p, v, R = triple(x), (x[3], x[4], x[5]), rotation(x[6:10])
    constants = estimated_constants(aid, x)
    reading.nis, reading.outcome = 0.0, REJECTED
    for i in range(3):
        reading.innovation[i] = 0.0
    if not expect(aid, constants, p, v, R, w, expected, H_motion, H_constants):
        return  # the sensor saw a heading where the estimate has none: nothing to compare, nothing to hold against it
    y, H, variance = np.empty(n), np.zeros((n, size)), aid.noise * aid.noise
    for i in range(n):
        y[i] = reading.innovation[i] = difference(aid, reading.value[i], expected[i])
        for j in range(12):
            H[i, j] = H_motion[i, j]
        for j in range(aid.constants):
            H[i, aid.place + j] = H_constants[i, j]
    later, covariance, nis = corrected(x, memory.P, H, y, variance)
    outcome, last = FUSED, memory.rejected[reading.aid]
    in_a_row = memory.rejections[reading.aid]
    if nis > aid.gate:
        if in_a_row > 0 and not agrees(aid, y, last, sqrt(x[3] ** 2 + x[4] ** 2 + x[5] ** 2)):
            in_a_row = 0  # outliers that contradict each other say nothing of the estimate
        outcome = REJECTED
        if in_a_row >= MAX_REJECTIONS:
            factor = nis / aid.gate
            for _ in range(MOST_DOUBTS):
                later, covariance, left = corrected(x, inflated(aid.kind, memory.P, factor), H, y, variance)
                if left <= aid.gate:
                    outcome = ACCEPTED_AFTER_REJECTIONS
                    break
                factor *= 2.0 * left / aid.gate  # the variances raised are not all of the innovation's
        for i in range(n):
            last[i] = y[i]
    memory.rejections[reading.aid] = in_a_row + 1 if nis > aid.gate else 0
    if outcome != REJECTED:
        set_estimate(x, memory.P, later, covariance)
        hold_speed(x)
    reading.nis, reading.outcome = nis, outcome


@inlined
def falls_freely(reading):
    """Whether an inertial unit reads (9,) what only a hull in a vacuum would make it read."""
    return reading[3] ** 2 + reading[4] ** 2 + reading[5] ** 2 < FREE_FALL**2


@inlined
def of_no_motion(x, gravity):
    """The means (6,) that an inertial unit would read of a vehicle that goes on as a state x says that it moves."""
    reading, R = np.empty(6), rotation(x[6:10])
    for i in range(3):
        reading[i] = x[10 + i]
        reading[3 + i] = x[13 + i] - (R[0, i] * gravity[0] + R[1, i] * gravity[1] + R[2, i] * gravity[2])
    return reading


@inlined
def noise_of(settings, dead):
    """Densities (6,) of the noise of an inertial unit, whose word is not taken while it is dead."""
    noise = np.empty(6)
    for i in range(6):
        noise[i] = settings.noise[i]
        if dead:
            noise[i] = UNKNOWN_RATE if i < 3 else UNKNOWN_ACCELERATION
    return noise


@inlined
def open_tick(memory, inertial):
    """Begin the next tick (the first time: tick 0), with no readings yet; the estimate stays behind until `run_since`.

    Args:
        memory: `FilterMemory`, moved on.
        inertial: (9,) reading of the inertial unit at that tick.
    """
    memory.tick[0] += 1
    at = memory.tick[0] % len(memory.states)
    for i in range(INERTIAL):
        memory.inertials[at, i] = inertial[i]
    for i in range(len(memory.rejections)):
        memory.readings[at, i].whereabouts = NONE


@compiled
def run_since(settings, aids, memory, first):
    """Bring the estimate to the present tick: from the one before, or again from a tick further back.

    Args:
        settings: record `FILTER`.
        aids: (k,) of `cube_sim.navigation.aid.AID`.
        memory: `FilterMemory`, moved on.
        first: the earliest tick of which a reading is new; the present one for none.
    """
    s, now, ticks = settings[0], memory.tick[0], len(memory.states)
    for tick in range(first, now + 1):
        at = tick % ticks
        if tick == first and tick < now:
            recall(memory, at)
        else:
            if tick > 0:
                mean = memory.inertials[at]
                dead = falls_freely(mean)
                if dead:
                    mean = of_no_motion(memory.x, s.gravity)
                x, P = predict(memory.x, memory.P, mean, s.gravity, s.period_s, noise_of(s, dead), s.walk)
                set_estimate(memory.x, memory.P, x, P)
                hold_speed(memory.x)
            remember(memory, at)
        for i in range(len(aids)):
            if memory.readings[at, i].whereabouts == ARRIVED:
                fuse(aids[i], memory, memory.readings[at, i], memory.inertials[at])
