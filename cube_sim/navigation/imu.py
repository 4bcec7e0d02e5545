"""The inertial unit: angular rates and specific force at every tick, with noise and wandering biases."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.spatial import Record, Vector

IMU = np.dtype([("noise", np.float64, 6), ("walk", np.float64, 6)])
"""Standard deviations of the noise of a reading and of the biases' steps from one to the next [rad/s, m/s^2]."""
IMU_MEMORY = np.dtype([("bias", np.float64, 6), ("reading", np.float64, 6), ("started", np.int64)])
"""The true biases and the latest reading [rad/s, m/s^2], and whether there is one."""
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
def read_imu(imu, memory, rates, specific_force, normals):
    """The next reading [w; f] + bias + noise of a unit at the body origin, aligned with the body axes.

    Args:
        imu: record `IMU`.
        memory: record `IMU_MEMORY`, moved on.
        rates: true w (3,) [rad/s], body axes.
        specific_force: true f (3,) [m/s^2], body axes.
        normals: (12,) standard normal numbers.
    """
    k, m = imu[0], memory[0]
    for i in range(6):
        if m.started:
            m.bias[i] += k.walk[i] * normals[i]
        true = rates[i] if i < 3 else specific_force[i - 3]
        m.reading[i] = true + m.bias[i] + k.noise[i] * normals[6 + i]
    m.started = 1
