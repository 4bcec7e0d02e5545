"""The error-state filter of a vehicle: what it knows of its sensors, and its memory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.navigation.aid import Aid, aid_records
from cube_sim.navigation.filtering import FILTER, FilterMemory, open_tick, run_since
from cube_sim.navigation.imu import INERTIAL, ImuErrors
from cube_sim.navigation.reading import ARRIVED, READING, Fusion, Reading, fusion_of
from cube_sim.navigation.strapdown import CONSTANTS
from cube_sim.spatial import Matrix, Record, Vector


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
        settings: record `FILTER`.
        aids: (k,) of `AID`.
        memory: the estimate at the present tick, and what is remembered.
    """

    def __init__(
        self, x: Vector, P: Matrix, imu: ImuErrors, aids: Sequence[Aid], gravity: Vector, period_s: float
    ) -> None:
        size = CONSTANTS + sum(len(aid.constants) for aid in aids)
        if P.shape != (size, size) or x.shape != (size + 1,):
            raise ValueError(f"these aids make {size} errors; x has {x.shape}, P {P.shape}")
        self.aids: Record = aid_records(aids, period_s)
        self.settings: Record = np.zeros(1, FILTER)
        self.settings["period_s"], self.settings["gravity"] = period_s, gravity
        self.settings["noise"], self.settings["walk"] = imu.noise, imu.bias_walk
        self._longest = int(self.aids["delay"].max(initial=0))
        k, ticks = len(aids), self._longest + 1
        self.memory = FilterMemory(
            tick=np.full(1, -1),
            x=np.array(x, dtype=float),
            P=np.array(P, dtype=float),
            rejections=np.zeros(k, np.int64),
            rejected=np.zeros((k, 3)),
            inertials=np.zeros((ticks, INERTIAL)),
            states=np.zeros((ticks, size + 1)),
            covariances=np.zeros((ticks, size, size)),
            rejections_before=np.zeros((ticks, k), np.int64),
            rejected_before=np.zeros((ticks, k, 3)),
            readings=np.zeros((ticks, k), READING),
        )

    @property
    def x(self) -> Vector:
        """State at the present tick."""
        return self.memory.x

    @property
    def P(self) -> Matrix:
        """Covariance of its error."""
        return self.memory.P

    def step(self, inertial: Vector, readings: Sequence[Reading] = ()) -> list[Fusion]:
        """Go on to the next tick (at the first call: to tick 0) and fuse what has arrived by then.

        Args:
            inertial: (9,) reading of the inertial unit at this tick, as `cube_sim.navigation.imu.INERTIAL` says.
            readings: of the other sensors, each of this tick or an earlier one, at most one of a sensor and a tick.

        Returns:
            What became of the readings, in their order.

        Raises:
            ValueError: a reading of the future, or older than the longest delay of the sensors.
        """
        memory, ticks = self.memory, len(self.memory.states)
        tick = int(memory.tick[0]) + 1
        for reading in readings:
            if not max(tick - self._longest, 0) <= reading.tick <= tick:
                raise ValueError(f"a reading of tick {reading.tick} cannot be fused at tick {tick}")
        open_tick(memory, inertial)
        for reading in readings:
            place = memory.readings[reading.tick % ticks, reading.aid]
            place["aid"], place["tick"], place["whereabouts"] = reading.aid, reading.tick, ARRIVED
            place["value"][: len(reading.value)] = reading.value
        run_since(self.settings, self.aids, memory, min([tick, *(reading.tick for reading in readings)]))
        places = [memory.readings[reading.tick % ticks, reading.aid] for reading in readings]
        return [fusion_of(place, int(self.aids["components"][place["aid"]])) for place in places]

    def constants(self, aid: int) -> Vector:
        """Estimated constant errors (c,) of a sensor."""
        first = int(self.aids["place"][aid]) + 1
        return self.memory.x[first : first + int(self.aids["constants"][aid])]
