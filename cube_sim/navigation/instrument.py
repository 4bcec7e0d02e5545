"""An aiding sensor at work: it samples the truth with its errors, and the reading arrives late."""

from __future__ import annotations

from collections import deque

import numpy as np

from cube_sim.navigation.aid import Aid, Reading
from cube_sim.navigation.motion import Motion
from cube_sim.spatial import Vector


class Instrument:
    """One sensor of a run.

    Args:
        index: its place among the sensors.
        aid: what it measures and how well.
        random: its own stream.
        period_s: length of a tick.

    Attributes:
        constants: its true constant errors (c,), which nobody else knows.
    """

    def __init__(self, index: int, aid: Aid, random: np.random.Generator, period_s: float) -> None:
        self._index, self._aid, self._random, self._period = index, aid, random, period_s
        self._delay = aid.sampling.delay_ticks(period_s)
        self._samples, self._next = 0, 0
        self._in_transit: deque[Reading] = deque()
        self.constants: Vector = aid.constants * random.standard_normal(len(aid.constants))

    def read(self, truth: Motion, tick: int) -> list[Reading]:
        """Take a reading when one is due, and hand over those that have arrived; once per tick."""
        if tick == self._next:
            self._samples += 1
            self._next = self._aid.sampling.tick_of(self._samples, self._period)
            expected = self._aid.expect(truth, self.constants)
            if expected is not None:
                noise = self._aid.noise * self._random.standard_normal(len(expected.value))
                self._in_transit.append(Reading(self._index, tick, expected.value + noise))
        arrived = []
        while self._in_transit and self._in_transit[0].tick + self._delay <= tick:
            arrived.append(self._in_transit.popleft())
        return arrived
