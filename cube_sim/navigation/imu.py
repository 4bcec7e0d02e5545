"""The inertial unit: how the hull turned and was pushed since the tick before, with noise and wandering biases.

Such a unit samples at a kilohertz or more and adds up what it reads, the turning of its own axes taken account of
(coning and sculling compensated; P. Savage 1998, "Strapdown inertial navigation integration algorithm design", J. of
Guidance, Control and Dynamics 21). So nothing is lost between two ticks, however the thrusters' forces change there.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.strapdown import rotation_vector
from cube_sim.spatial import Record, Vector
from cube_sim.tuples import put, put_matrix

IMU = np.dtype([("noise", np.float64, 6), ("walk", np.float64, 6)])
"""Standard deviations of the noise of a reading and of the biases' steps from one to the next [rad/s, m/s^2]."""
INERTIAL = 9
"""Numbers in a reading, in body axes: mean angular velocity [rad/s] and mean specific force [m/s^2] since the tick
before, and the angular velocity at this one [rad/s].

The means are the rotation vector of the turn over dt, and what was gained of velocity beside gravity over dt, in the
axes that the body had at the tick before.
"""
IMU_MEMORY = np.dtype(
    [
        ("bias", np.float64, 6),
        ("reading", np.float64, INERTIAL),
        ("rotation", np.float64, (3, 3)),
        ("velocity", np.float64, 3),
        ("started", np.int64),
    ]
)
"""The true biases [rad/s, m/s^2] and the latest reading; the true R_WB and velocity over ground [m/s], world axes, at
that tick; and whether there is one."""
IMU_NORMALS = 12
"""Standard normal numbers a reading takes: six steps of the biases, six of noise."""


@dataclass(frozen=True)
class ImuErrors:
    """How good an inertial unit is, each figure for each of its three axes.

    Attributes:
        gyro_noise: density of the white noise [rad/s/sqrt(Hz)].
        accelerometer_noise: the same [m/s^2/sqrt(Hz)].
        gyro_bias: standard deviation of the bias at the start [rad/s].
        accelerometer_bias: the same [m/s^2].
        gyro_bias_walk: density of the white noise whose integral the bias is [rad/s^2/sqrt(Hz)].
        accelerometer_bias_walk: the same [m/s^3/sqrt(Hz)].
    """

    gyro_noise: float
    accelerometer_noise: float
    gyro_bias: float
    accelerometer_bias: float
    gyro_bias_walk: float
    accelerometer_bias_walk: float

    @property
    def noise(self) -> Vector:
        """(6,) densities of the noise, gyro first."""
        return np.repeat([self.gyro_noise, self.accelerometer_noise], 3)

    @property
    def bias(self) -> Vector:
        """(6,) standard deviations of the biases at the start."""
        return np.repeat([self.gyro_bias, self.accelerometer_bias], 3)

    @property
    def bias_walk(self) -> Vector:
        """(6,) densities of the walks."""
        return np.repeat([self.gyro_bias_walk, self.accelerometer_bias_walk], 3)

    def record(self, period_s: float) -> Record:
        """A unit with these errors that is read once per period: (1,) of `IMU`.

        The noise of a sample is its density / sqrt(period), as a unit shows it that averages over the period between
        two readings.
        """
        record = np.zeros(1, IMU)
        record["noise"], record["walk"] = self.noise / sqrt(period_s), self.bias_walk * sqrt(period_s)
        return record


@inlined
def read_imu(imu, memory, velocity, R, rates, gravity, period_s, normals):
    """The next reading of a unit at the body origin, aligned with the body axes.

    The first is that of a motion that has been steady.

    Args:
        imu: record `IMU`.
        memory: record `IMU_MEMORY`, moved on.
        velocity: true v over ground (3,) [m/s], world axes.
        R: true R_WB (3,3).
        rates: true w (3,) [rad/s], body axes.
        gravity: (3,) world axes [m/s^2].
        period_s: since the tick before.
        normals: (12,) standard normal numbers.
    """
    k, m = imu[0], memory[0]
    if not m.started:
        put(m.velocity, velocity)
        put_matrix(m.rotation, R)
    gained, turn, true = np.empty(3), np.zeros((3, 3)), np.zeros(6)
    for i in range(3):
        gained[i] = (velocity[i] - m.velocity[i]) / period_s - gravity[i]
        for j in range(3):
            for n in range(3):
                turn[i, j] += m.rotation[n, i] * R[n, j]
    angle = rotation_vector(turn)
    for i in range(3):
        true[i] = angle[i] / period_s if m.started else rates[i]
        for j in range(3):
            true[3 + i] += m.rotation[j, i] * gained[j]
    for i in range(6):
        if m.started:
            m.bias[i] += k.walk[i] * normals[i]
        m.reading[i] = true[i] + m.bias[i] + k.noise[i] * normals[6 + i]
    for i in range(3):
        m.reading[6 + i] = rates[i] + m.bias[i] + k.noise[i] * normals[6 + i]
    put(m.velocity, velocity)
    put_matrix(m.rotation, R)
    m.started = 1
