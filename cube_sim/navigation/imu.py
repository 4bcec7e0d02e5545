"""The inertial unit: angular rates and specific force at every tick, with noise and wandering biases."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from cube_sim.navigation.motion import Truth
from cube_sim.spatial import Vector


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


class Imu:
    """An inertial unit at the body origin, aligned with the body axes.

    A reading is [w; f] + bias + noise with the noise of a sample its density / sqrt(period), as a unit shows it that
    averages over the period between two readings.

    Args:
        errors: how good it is.
        random: its own stream.
        period_s: time between two readings.
    """

    def __init__(self, errors: ImuErrors, random: np.random.Generator, period_s: float) -> None:
        self._random = random
        self._noise = errors.noise / sqrt(period_s)
        self._walk = errors.bias_walk * sqrt(period_s)
        self.bias = errors.bias * random.standard_normal(6)
        """True bias (6,) of the latest reading [rad/s, m/s^2]."""
        self._first = True

    def read(self, truth: Truth) -> Vector:
        """(6,) angular rates [rad/s] and specific force [m/s^2], body axes; once per period."""
        step, noise = self._random.standard_normal((2, 6))
        if not self._first:
            self.bias = self.bias + self._walk * step
        self._first = False
        return np.concatenate([truth.motion.rates, truth.specific_force]) + self.bias + self._noise * noise
