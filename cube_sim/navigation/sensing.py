"""The aiding sensors at work, compiled: they sample the truth with their errors, and the readings arrive late."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.expectation import expect
from cube_sim.navigation.faults import is_lost, spoil
from cube_sim.navigation.reading import ARRIVED, NONE, UNDER_WAY
from cube_sim.navigation.sampling import tick_of_sample
from cube_sim.tuples import triple

SENSOR = np.dtype([("constants", np.float64, 4), ("samples", np.int64), ("due", np.int64)])
"""What one sensor remembers: its true constant errors, which nobody else knows, the samples so far, and the tick of the
next one."""


MOTION = 18
"""Numbers in a motion: position, velocity, rotation, rates."""


@inlined
def put_motion(row, position, velocity, R, rates):
    """Fill (18,) with a motion, in the order of the arguments."""
    for i in range(3):
        row[i], row[3 + i], row[15 + i] = position[i], velocity[i], rates[i]
        for j in range(3):
            row[6 + 3 * i + j] = R[i, j]


@inlined
def take_readings(aids, sensors, faults, motions, normals, readings, tick, period_s, position, velocity, R, rates):
    """Every sensor whose turn it is reads the truth, or what its faults make of that.

    Args:
        aids: (k,) of `cube_sim.navigation.aid.AID`.
        sensors: (k,) of `SENSOR`, moved on.
        faults: (1 + k,) of `cube_sim.navigation.faults.FAULT`, the inertial unit's first.
        motions: (L, 18) the motions of the last L ticks, as they are put here: for sensors that are late.
        normals: `cube_sim.navigation.normals.Normals`, moved on.
        readings: (N, k) of `cube_sim.navigation.reading.READING`, a row for each of the last N ticks, filled.
        tick: the present one.
        period_s: its length [s].
        position: true p_WB (3,) [m], world axes.
        velocity: over ground (3,) [m/s], world axes.
        R: R_WB (3,3).
        rates: w (3,) [rad/s], body axes.
    """
    value, H_motion, H_constants = np.empty(3), np.empty((3, 12)), np.empty((3, 4))
    p, v, w = triple(position), triple(velocity), triple(rates)
    put_motion(motions[tick % len(motions)], position, velocity, R, rates)
    for i in range(len(aids)):
        aid, sensor = aids[i], sensors[i]
        if tick != sensor.due:
            continue
        sensor.samples += 1
        sensor.due = tick_of_sample(sensor.samples, aid.rate_hz, period_s)
        c, fault = sensor.constants, faults[1 + i]
        own = (c[0], c[1], c[2], c[3])
        if fault.late > 0:
            m = motions[max(tick - fault.late, 0) % len(motions)]
            past_p, past_v, past_w = triple(m[:3]), triple(m[3:6]), triple(m[15:])
            there = expect(aid, own, past_p, past_v, m[6:15].reshape(3, 3), past_w, value, H_motion, H_constants)
        else:
            there = expect(aid, own, p, v, R, w, value, H_motion, H_constants)
        if there:
            reading, first = readings[tick % len(readings), i], normals.used[1 + i]
            reading.aid, reading.tick, reading.whereabouts = i, tick, UNDER_WAY
            for j in range(aid.components):
                reading.value[j] = value[j] + aid.noise * normals.values[1 + i, first + j]
            normals.used[1 + i] = first + aid.components
            # A sensor that is lost takes its numbers all the same: what it reads later is what it would have read.
            spoil(fault, reading.value, aid.components, normals)
            if is_lost(fault, p[2], R[2, 2]):
                reading.whereabouts = NONE


@inlined
def receive(aids, readings, tick):
    """The readings that arrive at a tick are there from now on; the tick at which the earliest of them was taken.

    Arguments as in `take_readings`; without a reading the present tick is returned.
    """
    earliest = tick
    for i in range(len(aids)):
        taken = tick - aids[i].delay
        if taken >= 0 and readings[taken % len(readings), i].whereabouts == UNDER_WAY:
            readings[taken % len(readings), i].whereabouts = ARRIVED
            earliest = min(earliest, taken)
    return earliest
