"""All of a tick of navigation in one compiled call, from the truth to the estimate of it.

Types of arguments depend neither on which sensors there are nor on how many: it is compiled once for all vehicles.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled, inlined
from cube_sim.navigation.faults import spoil
from cube_sim.navigation.filtering import FilterMemory, open_tick, run_since
from cube_sim.navigation.imu import IMU_NORMALS, INERTIAL, read_imu
from cube_sim.navigation.normals import Normals
from cube_sim.navigation.reading import ARRIVED
from cube_sim.navigation.sensing import receive, take_readings
from cube_sim.navigation.strapdown import rotation, rotation_vector
from cube_sim.spatial import Matrix, Record

ESTIMATE = np.dtype(
    [
        ("position", np.float64, 3),
        ("quaternion", np.float64, 4),
        ("rotation", np.float64, (3, 3)),
        ("velocity", np.float64, 3),
        ("rates", np.float64, 3),
        ("position_sigma", np.float64, 3),
        ("velocity_sigma", np.float64, 3),
        ("attitude_sigma", np.float64, 3),
        ("gyro_bias", np.float64, 3),
        ("accelerometer_bias", np.float64, 3),
    ]
)
"""What is known at a tick, with standard deviations as the filter believes them.

The estimated `State`, whose names come first; the standard deviations of position [m] and velocity [m/s], world axes,
and of the attitude [rad], a rotation vector in world axes, whose last is the heading's; the biases [rad/s, m/s^2].
"""
ERROR = np.dtype(
    [
        ("position", np.float64, 3),
        ("velocity", np.float64, 3),
        ("attitude", np.float64, 3),
        ("gyro_bias", np.float64, 3),
        ("accelerometer_bias", np.float64, 3),
    ]
)
"""Estimated less true position [m], velocity [m/s], attitude [rad], biases [rad/s, m/s^2].

World axes; the attitude's is the rotation vector that turns the true attitude into the estimated one.
"""


class NavigationParameters(NamedTuple):
    """What does not change in a flight.

    Attributes:
        imu: record `cube_sim.navigation.imu.IMU`.
        aids: (k,) of `cube_sim.navigation.aid.AID`.
        filter: record `cube_sim.navigation.filtering.FILTER`.
    """

    imu: Record
    aids: Record
    filter: Record


class NavigationMemory(NamedTuple):
    """What is moved on.

    Attributes:
        imu: record `cube_sim.navigation.imu.IMU_MEMORY`.
        sensors: (k,) of `cube_sim.navigation.sensing.SENSOR`.
        faults: (1 + k,) of `cube_sim.navigation.faults.FAULT`, the inertial unit's first; changed by events.
        motions: (L, 18) of `take_readings`.
        normals: standard normal numbers for the noise.
        filter: the filter's.
    """

    imu: Record
    sensors: Record
    faults: Record
    motions: Matrix
    normals: Normals
    filter: FilterMemory


@inlined
def tell(answer, x, P, inertial):
    """Fill a record `ESTIMATE` from the filter's state and covariance and the inertial unit's reading (9,)."""
    a, R = answer[0], rotation(x[6:10])
    for i in range(4):
        a.quaternion[i] = x[6 + i]
    for i in range(3):
        a.position[i], a.velocity[i], a.rates[i] = x[i], 0.0, inertial[6 + i] - x[10 + i]
        a.gyro_bias[i], a.accelerometer_bias[i] = x[10 + i], x[13 + i]
        for j in range(3):
            a.rotation[i, j] = R[i, j]
            a.velocity[i] += x[3 + j] * R[j, i]
        a.position_sigma[i], a.velocity_sigma[i] = sqrt(P[i, i]), sqrt(P[3 + i, 3 + i])
        a.attitude_sigma[i] = sqrt(P[6 + i, 6 + i])


@inlined
def compare(error, answer, position, velocity, R, biases):
    """Fill a record `ERROR` from a record `ESTIMATE` and the truth, biases (6,) [rad/s, m/s^2]."""
    e, a = error[0], answer[0]
    turn = np.zeros((3, 3))
    for i in range(3):
        e.position[i], e.velocity[i] = a.position[i] - position[i], -velocity[i]
        e.gyro_bias[i] = a.gyro_bias[i] - biases[i]
        e.accelerometer_bias[i] = a.accelerometer_bias[i] - biases[3 + i]
        for j in range(3):
            e.velocity[i] += a.rotation[i, j] * a.velocity[j]
            for k in range(3):
                turn[i, j] += a.rotation[i, k] * R[j, k]
    e.attitude[0], e.attitude[1], e.attitude[2] = rotation_vector(turn)


@compiled
def estimate(parameters, memory, position, velocity, R, rates, answer, error, arrived):
    """Go on by one tick (at the first call: to t = 0): read the sensors, fuse what has arrived.

    Args:
        parameters: `NavigationParameters`.
        memory: `NavigationMemory`, moved on; with numbers left for this tick.
        position: true p_WB (3,) [m], world axes.
        velocity: of the body origin over ground (3,) [m/s], world axes.
        R: R_WB (3,3).
        rates: w (3,) [rad/s], body axes.
        answer: record `ESTIMATE`, filled.
        error: record `ERROR`, filled.
        arrived: (k,) of `cube_sim.navigation.reading.READING`; the first of them are filled, in the order of the
            sensors.

    Returns:
        How many readings have arrived.
    """
    aids, filter_ = parameters.aids, memory.filter
    gravity, period_s = parameters.filter[0].gravity, parameters.filter[0].period_s
    first = memory.normals.used[0]
    normals = memory.normals.values[0, first : first + IMU_NORMALS]
    read_imu(parameters.imu, memory.imu, velocity, R, rates, gravity, period_s, normals)
    memory.normals.used[0] = first + IMU_NORMALS
    spoil(memory.faults[0], memory.imu[0].reading, INERTIAL, memory.normals)
    inertial = np.empty(INERTIAL)
    for i in range(INERTIAL):
        inertial[i] = memory.imu[0].reading[i]
    open_tick(filter_, inertial)
    tick, readings = filter_.tick[0], filter_.readings
    take_readings(
        aids, memory.sensors, memory.faults, memory.motions, memory.normals,
        readings, tick, period_s, position, velocity, R, rates,
    )  # fmt: skip
    run_since(parameters.filter, aids, filter_, receive(aids, readings, tick))
    tell(answer, filter_.x, filter_.P, inertial)
    compare(error, answer, position, velocity, R, memory.imu[0].bias)
    count = 0
    for i in range(len(aids)):
        taken = tick - aids[i].delay
        if taken >= 0 and readings[taken % len(readings), i].whereabouts == ARRIVED:
            arrived[count] = readings[taken % len(readings), i]
            count += 1
    return count
