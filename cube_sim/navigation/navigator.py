"""Sensors and filter of a vehicle together: the truth goes in, what the controller may know comes out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cube_sim.navigation.aid import Aid
from cube_sim.navigation.estimating import ERROR, ESTIMATE, NavigationMemory, NavigationParameters, estimate
from cube_sim.navigation.faults import SensorFaults
from cube_sim.navigation.filter import Filter
from cube_sim.navigation.imu import IMU_MEMORY, ImuErrors
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.normals import DrawnAhead
from cube_sim.navigation.own_aid import tell_laws
from cube_sim.navigation.reading import READING
from cube_sim.navigation.sensing import MOTION, SENSOR
from cube_sim.navigation.strapdown import ATTITUDE, POSITION, VELOCITY, turned
from cube_sim.navigation.streams import stream
from cube_sim.spatial import Record, Vector, conjugate, quaternion_from_rotation


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


class Navigator:
    """One vehicle's navigation: its sensors, each on its own random stream, and its filter.

    Args:
        imu: the inertial unit's errors.
        aids: the other sensors.
        initial: what is known at t = 0.
        truth: the true motion at t = 0, off which the first estimate lies by a drawn error.
        seed: root of the random streams.
        gravity: (3,) world axes [m/s^2].
        period_s: length of a tick.
        faults: of the sensors; None: they stay whole.

    Attributes:
        aids: the same.
        filter: its estimate.
        answer: record `ESTIMATE` of the latest tick.
        error: record `ERROR` of the latest tick.
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
        faults: SensorFaults | None = None,
    ) -> None:
        self.aids = tuple(aids)
        k, constants = len(self.aids), np.concatenate([np.zeros(0), *(aid.constants for aid in self.aids)])
        sigma = np.concatenate([initial.sigma, imu.bias, constants])
        error = initial.sigma * stream(seed, "initial estimate").standard_normal(9)
        # The estimate is R = Exp(-phi) R_true, and q = (q_true* exp(phi))*.
        q = conjugate(turned(conjugate(quaternion_from_rotation(truth.rotation)), error[ATTITUDE]))
        x = np.concatenate(
            [truth.position - error[POSITION], truth.velocity - error[VELOCITY], q, np.zeros(6 + len(constants))]
        )
        self.filter = Filter(x, np.diag(sigma**2), imu, self.aids, gravity, period_s)
        self._parameters = NavigationParameters(imu.record(period_s), self.filter.aids, self.filter.settings)
        streams = [stream(seed, name) for name in ("imu", *(aid.name for aid in self.aids))]
        self._imu: Record = np.zeros(1, IMU_MEMORY)
        self._imu["bias"] = imu.bias * streams[0].standard_normal(6)
        self._sensors: Record = np.zeros(k, SENSOR)
        for sensor, aid, own in zip(self._sensors, self.aids, streams[1:], strict=True):
            c = len(aid.constants)
            sensor["constants"][:c] = aid.constants * own.standard_normal(c)
        names = "imu", *(aid.name for aid in self.aids)
        self._faults = SensorFaults(names) if faults is None else faults
        self._motions = np.zeros((self._faults.latest + 1, MOTION))
        self._drawn = DrawnAhead([*streams, *(stream(seed, f"{name} outliers") for name in self._faults.outliers)])
        self.answer: Record = np.zeros(1, ESTIMATE)
        self.error: Record = np.zeros(1, ERROR)
        self._arrived: Record = np.zeros(k, READING)

    @property
    def inertial(self) -> Vector:
        """The inertial unit's latest reading (9,), as `cube_sim.navigation.imu.INERTIAL` says."""
        return self._imu["reading"][0]

    @property
    def true_biases(self) -> Vector:
        """(6,) of the inertial unit's latest reading, which the filter does not know [rad/s, m/s^2]."""
        return self._imu["bias"][0]

    def true_constants(self, aid: int) -> Vector:
        """Constant errors (c,) of a sensor, which the filter does not know."""
        return self._sensors["constants"][aid, : len(self.aids[aid].constants)]

    def stage(self, ticks: int) -> tuple[NavigationParameters, NavigationMemory]:
        """The first arguments of `estimate`, for so many ticks."""
        self._drawn.reserve(ticks)
        tell_laws(self.filter.aids, self.aids)
        faulty = self._faults.records, self._motions
        memory = NavigationMemory(self._imu, self._sensors, *faulty, self._drawn.normals, self.filter.memory)
        return self._parameters, memory

    def update(self, truth: Motion) -> Record:
        """Go on by one tick (at the first call: to t = 0); the readings that have arrived, of `READING`."""
        self.answer, self.error = np.zeros(1, ESTIMATE), np.zeros(1, ERROR)
        into = self.answer, self.error, self._arrived
        count = estimate(*self.stage(1), *truth, *into)
        return self._arrived[:count]
