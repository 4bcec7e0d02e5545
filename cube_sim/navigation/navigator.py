"""Sensors and filter of a vehicle together: the truth goes in, what the controller may know comes out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cube_sim.navigation.aid import Aid
from cube_sim.navigation.filter import Filter, Fusion
from cube_sim.navigation.imu import Imu, ImuErrors
from cube_sim.navigation.instrument import Instrument
from cube_sim.navigation.motion import Motion, Truth
from cube_sim.navigation.strapdown import ACCELEROMETER_BIAS, ATTITUDE, GYRO_BIAS, POSITION, VELOCITY, rotation, turned
from cube_sim.navigation.streams import stream
from cube_sim.spatial import (
    Matrix,
    State,
    Vector,
    conjugate,
    quaternion_from_rotation,
)


@dataclass(frozen=True)
class InitialErrors:
    """How well the vehicle knows its state at t = 0: standard deviations per axis.

    Attributes:
        position: [m].
        velocity: [m/s].
        tilt: of the vertical [rad].
        heading: [rad].
    """

    position: float
    velocity: float
    tilt: float
    heading: float

    @property
    def sigma(self) -> Vector:
        """(9,) in the order of the filter's error."""
        return np.concatenate([np.repeat([self.position, self.velocity, self.tilt], 3)[:8], [self.heading]])


class Estimate(NamedTuple):
    """What is known at a tick, with standard deviations as the filter believes them.

    Attributes:
        state: for the controller.
        position_sigma: (3,) [m], world axes.
        velocity_sigma: (3,) [m/s], world axes.
        attitude_sigma: (3,) [rad], rotation vector in world axes; the last is the heading's.
        gyro_bias: (3,) [rad/s].
        accelerometer_bias: (3,) [m/s^2].
        covariance: (15 + c, 15 + c) of the error, laid out as in `cube_sim.navigation.strapdown`.
    """

    state: State
    position_sigma: Vector
    velocity_sigma: Vector
    attitude_sigma: Vector
    gyro_bias: Vector
    accelerometer_bias: Vector
    covariance: Matrix


class Navigator:
    """One vehicle's navigation: its instruments, each on its own random stream, and its filter.

    Args:
        imu: the inertial unit's errors.
        aids: the other sensors.
        initial: what is known at t = 0.
        truth: the true motion at t = 0, off which the first estimate lies by a drawn error.
        seed: root of the random streams.
        gravity: (3,) world axes [m/s^2].
        period_s: length of a tick.

    Attributes:
        inertial: the inertial unit's latest reading (6,) [rad/s, m/s^2].
    """

    def __init__(
        self,
        imu: ImuErrors,
        aids: Sequence[Aid],
        initial: InitialErrors,
        truth: Motion,
        seed: int,
        gravity: Vector,
        period_s: float,
    ) -> None:
        self.aids = tuple(aids)
        self._imu = Imu(imu, stream(seed, "imu"), period_s)
        self._instruments = [
            Instrument(index, aid, stream(seed, aid.name), period_s) for index, aid in enumerate(self.aids)
        ]
        constants = np.concatenate([np.zeros(0), *(aid.constants for aid in self.aids)])
        sigma = np.concatenate([initial.sigma, imu.bias, constants])
        error = initial.sigma * stream(seed, "initial estimate").standard_normal(9)
        # The estimate is R = Exp(-phi) R_true, and q = (q_true* exp(phi))*.
        q = conjugate(turned(conjugate(quaternion_from_rotation(truth.rotation)), error[ATTITUDE]))
        x = np.concatenate(
            [truth.position - error[POSITION], truth.velocity - error[VELOCITY], q, np.zeros(6 + len(constants))]
        )
        self._filter = Filter(x, np.diag(sigma**2), imu, self.aids, gravity, period_s)
        self._tick = -1
        self.inertial = np.zeros(6)

    @property
    def true_biases(self) -> Vector:
        """(6,) of the inertial unit's latest reading, which the filter does not know [rad/s, m/s^2]."""
        return self._imu.bias

    def true_constants(self, aid: int) -> Vector:
        """Constant errors (c,) of a sensor, which the filter does not know."""
        return self._instruments[aid].constants

    def constants(self, aid: int) -> Vector:
        """The same as the filter estimates them."""
        return self._filter.constants(aid)

    def update(self, truth: Truth) -> tuple[Estimate, list[Fusion]]:
        """Go on by one tick (at the first call: to t = 0); the estimate, and the readings that have arrived."""
        self._tick += 1
        self.inertial = self._imu.read(truth)
        readings = [
            reading for instrument in self._instruments for reading in instrument.read(truth.motion, self._tick)
        ]
        fusions = self._filter.step(self.inertial, readings)
        return self._estimate(), fusions

    def _estimate(self) -> Estimate:
        x, P = self._filter.x, self._filter.P
        R = rotation(x[6:10])
        sigma = np.sqrt(P.diagonal())
        state = State(
            position=x[0:3].copy(),
            quaternion=x[6:10].copy(),
            rotation=R,
            velocity=x[3:6] @ R,
            rates=self.inertial[:3] - x[10:13],
        )
        return Estimate(
            state=state,
            position_sigma=sigma[POSITION],
            velocity_sigma=sigma[VELOCITY],
            attitude_sigma=sigma[ATTITUDE],
            gyro_bias=x[GYRO_BIAS.start + 1 : GYRO_BIAS.stop + 1].copy(),
            accelerometer_bias=x[ACCELEROMETER_BIAS.start + 1 : ACCELEROMETER_BIAS.stop + 1].copy(),
            covariance=P,
        )
