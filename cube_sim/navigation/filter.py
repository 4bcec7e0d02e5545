"""The filter: strapdown prediction, readings fused at the instant they speak of, and a gate against outliers."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.special import chdtri

from cube_sim.navigation.aid import Aid, Reading
from cube_sim.navigation.correction import corrected
from cube_sim.navigation.imu import ImuErrors
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.strapdown import ATTITUDE, CONSTANTS, predict, rotation
from cube_sim.spatial import Matrix, Vector

FALSE_ALARM_PROBABILITY = 1e-4
"""Share of the readings of a sensor as good as stated that the gate rejects."""
GATES = {n: float(chdtri(n, FALSE_ALARM_PROBABILITY)) for n in (1, 2, 3)}
"""The NIS beyond which a reading of n components is rejected, from the chi-square distribution."""
MAX_REJECTIONS = 3
"""Readings of a sensor rejected in a row after which the estimate is doubted, not the sensor."""


class ReadingOutcome(IntEnum):
    """What became of a reading."""

    FUSED = 0
    REJECTED = 1
    ACCEPTED_AFTER_REJECTIONS = 2
    """Fused after its predecessors were rejected; the covariance of position, velocity and attitude was inflated."""


class Fusion(NamedTuple):
    """A reading and what the filter made of it.

    Attributes:
        reading: the reading.
        innovation: (n,) the reading less the one expected by the estimate of its instant.
        nis: normalised innovation squared y' S^-1 y; y the innovation, S its covariance.
        outcome: fused or not.
    """

    reading: Reading
    innovation: Vector
    nis: float
    outcome: ReadingOutcome


@dataclass
class _Epoch:
    """A tick as the filter remembers it: the estimate before its readings, and these."""

    x: Vector
    P: Matrix
    inertial: Vector
    rejections: tuple[int, ...]
    readings: list[Reading] = field(default_factory=list)


class Filter:
    """An error-state extended Kalman filter with a multiplicative quaternion and a memory.

    A reading that arrives late is fused at the tick it speaks of; from there the filter runs again over the inertial
    readings and the other sensors' it remembers. When the last of them has arrived the estimate is, to the bit, the one
    of a filter that got each at its instant.

    Args:
        x: (16 + c,) state at tick 0, laid out as in `cube_sim.navigation.strapdown`.
        P: (15 + c, 15 + c) covariance of its error.
        imu: the inertial unit's stated errors.
        aids: the other sensors, their c constants in this order.
        gravity: (3,) world axes [m/s^2].
        period_s: length of a tick.

    Attributes:
        x: state at the present tick.
        P: covariance of its error.
    """

    def __init__(
        self, x: Vector, P: Matrix, imu: ImuErrors, aids: Sequence[Aid], gravity: Vector, period_s: float
    ) -> None:
        self.x, self.P = x, P
        self._aids, self._gravity, self._period = tuple(aids), np.array(gravity, dtype=float), period_s
        self._noise, self._walk = imu.noise, imu.bias_walk
        ends = np.cumsum([CONSTANTS, *(len(aid.constants) for aid in aids)]).tolist()
        if P.shape != (ends[-1], ends[-1]) or x.shape != (ends[-1] + 1,):
            raise ValueError(f"these aids make {ends[-1]} errors; x has {x.shape}, P {P.shape}")
        self._places = [slice(first, last) for first, last in pairwise(ends)]
        memory = max((aid.sampling.delay_ticks(period_s) for aid in aids), default=0) + 1
        self._epochs: deque[_Epoch] = deque(maxlen=memory)
        self._tick = -1
        self._rejections = (0,) * len(self._aids)

    def step(self, inertial: Vector, readings: Sequence[Reading] = ()) -> list[Fusion]:
        """Go on to the next tick (at the first call: to tick 0) and fuse what has arrived by then.

        Args:
            inertial: (6,) reading of the inertial unit at this tick [rad/s, m/s^2].
            readings: of the other sensors, each of this tick or an earlier one.

        Returns:
            What became of the readings, in their order.

        Raises:
            ValueError: a reading of the future, or older than the longest delay of the sensors.
        """
        self._tick += 1
        if self._tick:
            last = self._epochs[-1]
            x, P = self._predict(self.x, self.P, last.inertial, inertial)
            self._epochs.append(_Epoch(x, P, inertial, self._rejections))
        else:
            self._epochs.append(_Epoch(self.x, self.P, inertial, self._rejections))
        first = len(self._epochs) - 1
        for reading in readings:
            index = len(self._epochs) - 1 - (self._tick - reading.tick)
            if not 0 <= index < len(self._epochs):
                raise ValueError(f"a reading of tick {reading.tick} cannot be fused at tick {self._tick}")
            self._epochs[index].readings.append(reading)
            self._epochs[index].readings.sort(key=lambda each: each.aid)
            first = min(first, index)
        made = self._run(first)
        return [made[reading.aid, reading.tick] for reading in readings]

    def constants(self, aid: int) -> Vector:
        """Estimated constant errors (c,) of a sensor."""
        place = self._places[aid]
        return self.x[place.start + 1 : place.stop + 1]

    def _run(self, first: int) -> dict[tuple[int, int], Fusion]:
        """From the remembered tick of this index to the present one."""
        made = {}
        for index in range(first, len(self._epochs)):
            epoch = self._epochs[index]
            if index > first:
                epoch.x, epoch.P = self._predict(self.x, self.P, self._epochs[index - 1].inertial, epoch.inertial)
                epoch.rejections = self._rejections
            self.x, self.P, self._rejections = epoch.x, epoch.P, epoch.rejections
            for reading in epoch.readings:
                fusion = self._fuse(reading, epoch.inertial)
                made[reading.aid, reading.tick] = fusion
        return made

    def _predict(self, x: Vector, P: Matrix, before: Vector, now: Vector) -> tuple[Vector, Matrix]:
        return predict(x, P, before, now, self._gravity, self._period, self._noise, self._walk)

    def _fuse(self, reading: Reading, inertial: Vector) -> Fusion:
        aid, place = self._aids[reading.aid], self._places[reading.aid]
        x = self.x
        motion = Motion(x[0:3], x[3:6], rotation(x[6:10]), inertial[:3] - x[10:13])
        expected = aid.expect(motion, x[place.start + 1 : place.stop + 1])
        if expected is None:
            # The sensor saw a heading where the estimate has none: nothing to compare, nothing to hold against it.
            return Fusion(reading, np.zeros(len(reading.value)), 0.0, ReadingOutcome.REJECTED)
        H = np.zeros((len(reading.value), len(self.P)))
        H[:, :12] = expected.H_motion
        H[:, place] = expected.H_constants
        y, variance = aid.innovation(reading.value, expected.value), aid.noise**2
        x, P, nis = corrected(self.x, self.P, H, y, variance)
        gate = GATES[len(y)]
        in_a_row = self._rejections[reading.aid]
        outcome = ReadingOutcome.FUSED
        if nis > gate:
            outcome = (
                ReadingOutcome.ACCEPTED_AFTER_REJECTIONS if in_a_row >= MAX_REJECTIONS else ReadingOutcome.REJECTED
            )
            in_a_row += 1
        else:
            in_a_row = 0
        self._rejections = (*self._rejections[: reading.aid], in_a_row, *self._rejections[reading.aid + 1 :])
        if outcome is ReadingOutcome.ACCEPTED_AFTER_REJECTIONS:
            x, P, _ = corrected(self.x, _inflated(self.P, nis / gate), H, y, variance)
        if outcome is not ReadingOutcome.REJECTED:
            self.x, self.P = x, P
        return Fusion(reading, y, nis, outcome)


def _inflated(P: Matrix, factor: float) -> Matrix:
    """The covariance with the variances of position, velocity and attitude raised by a factor.

    Those of the sensors' own errors stay: a filter that is lost would otherwise explain its being lost by them.
    """
    scale = np.ones(len(P))
    scale[: ATTITUDE.stop] = sqrt(factor)
    return P * np.outer(scale, scale)
