"""An aiding sensor at work: it looks at the truth, errs, and its reading arrives late."""

from __future__ import annotations

from collections import deque

import numpy as np

from cube_sim.navigation.aid import Aid
from cube_sim.navigation.filter import Reading
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
        self._looks, self._next = 0, 0
        self._under_way: deque[Reading] = deque()
        self.constants: Vector = aid.constants * random.standard_normal(len(aid.constants))

    def read(self, truth: Motion, tick: int) -> list[Reading]:
        """Look, if it is time, and hand over what has arrived; once per tick."""
        if tick == self._next:
            self._looks += 1
            self._next = self._aid.sampling.tick_of(self._looks, self._period)
            expected = self._aid.expect(truth, self.constants)
            if expected is not None:
                noise = self._aid.noise * self._random.standard_normal(len(expected.value))
                self._under_way.append(Reading(self._index, tick, expected.value + noise))
        arrived = []
        while self._under_way and self._under_way[0].tick + self._delay <= tick:
            arrived.append(self._under_way.popleft())
        return arrived
