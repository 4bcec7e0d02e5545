"""Finding thruster faults from what was commanded and what came back.

The force each thruster should give is known: its command through the motor's delay and lag and the characteristic. The
force it gives is measured (motor telemetry: speed and current). A sliding window of the two, x and y, is held against
what is believed of the thruster:

    whole  y = x
    weak   y = e x
    dead   y = 0
    stuck  y = c

The belief stays as long as it fits. When it no longer fits, the window has to say which of the others the thruster is
(`cube_sim.control.window_reading`).

A weak and a stuck thruster look alike while x stands still, and nearly so while it creeps: y = e x fits any constant.
So a thruster is believed weak only when its force was seen to move with x. It is believed stuck only when y = e x does
not fit. In between it is doubtful, and gets another command for a moment (`Probes`). Dead thrusters are probed too:
otherwise nothing would show that they recover.

Telemetry has a gain and noise. The gain is learned while the thruster is whole, and what is measured is divided by it.
Under noise longer windows find what is too faint for the first. And each has to say the same for as long as the first
is, or half its own length: while a fault moves through a window, the line that fits best turns all the time.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.probing import Probes
from cube_sim.control.telemetry_gain import TelemetryGain
from cube_sim.control.window_reading import Evidence, WindowReading, contradicts, read_window
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Vector
from cube_sim.wrench.health import Health

_LENGTHS = (1, 4, 16)
"""Lengths of the windows under noise, in lengths of the first."""
_SAME_EFFICIENCY = 0.1
"""Readings of an efficiency that differ by less are the same."""


class Diagnosis:
    """A running judgement of m thrusters.

    Args:
        window_s: length of the window [s]: the time a fault has to last to be believed.
        threshold_N: forces and differences below this say nothing [N].
        dt: control period [s].
        probe_N: (m,) what silent thrusters are asked for [N], well beyond the threshold.
        noise_N: standard deviation of a measured force [N], white.
        gain_tolerance: how far from 1 the gain of a measured force may be.

    Attributes:
        health: what is believed.
        doubtful: (m,) bool, which thrusters do something else than believed that can be read in more than one way.
    """

    def __init__(
        self,
        window_s: float,
        threshold_N: float,
        dt: float,
        probe_N: Vector,
        noise_N: float = 0.0,
        gain_tolerance: float = 0.0,
    ) -> None:
        n, m = max(2, round(window_s / dt)), len(probe_N)
        self._threshold, self._noise = threshold_N, noise_N
        self._lengths = tuple(n * k for k in _LENGTHS) if noise_N > 0.0 else (n,)
        self._expected, self._measured = np.zeros((self._lengths[-1], m)), np.zeros((self._lengths[-1], m))
        self._filled, self._row = 0, 0
        self._gain = TelemetryGain(m, gain_tolerance, n * threshold_N**2)
        self._suspect = np.zeros(m, dtype=bool)
        self._suggested: dict[tuple[int, int], tuple[WindowReading, int]] = {}
        self._age = np.full(m, self._lengths[-1])
        self._probes = Probes(probe_N, dt)
        self.health = Health.whole(m)
        self.doubtful = np.zeros(m, dtype=bool)

    def probed(self, force: Vector) -> Vector:
        """The forces (m,) [N] to ask for at this tick, a probe among them when one is due."""
        return self._probes.with_probe(force, self.health, self.doubtful)

    def update(self, expected: Vector, measured: Vector, force_ratio: float = 1.0) -> Health:
        """Judge after one more tick.

        Args:
            expected: (m,) forces [N] whole thrusters would give now, at the voltage of their characteristics.
            measured: (m,) forces [N] they are measured to give.
            force_ratio: the share of these forces that their supply leaves them, above 0.
        """
        noise = self._noise / force_ratio
        self._take(expected, measured / force_ratio, noise)
        self._age += 1
        self.doubtful = np.zeros(len(expected), dtype=bool)
        self._suspect[:] = False
        for n in self._lengths:
            if self._filled >= n:
                self._judge(n, noise)
        return self.health

    def _take(self, expected: Vector, measured: Vector, noise: float) -> None:
        """Put a pair of forces in the place of the oldest, of which the gains are learned."""
        row = self._row
        if self._filled == len(self._expected):
            sound = sound_pairs(*self.health, self._suspect, self._age, len(self._expected))
            self._gain.learn(self._expected[row], self._measured[row], sound, noise)
        self._expected[row], self._measured[row] = expected, measured
        self._row = (row + 1) % len(self._expected)
        self._filled = min(self._filled + 1, len(self._expected))

    def _judge(self, n: int, noise: float) -> None:
        """Believe something else of thrusters that do not do what is believed of them, if n ticks say what."""
        gain, health = self._gain.gain, self.health
        first = (self._row - n) % len(self._expected)
        contradicted = contradicts(
            self._expected, self._measured, first, n, *health, gain, self._threshold, float(noise)
        )
        if not (contradicted.any() or self._suggested):
            return
        newest = (first + np.arange(n)) % len(self._expected)
        x, y = self._expected[newest], self._measured[newest] / gain
        least, most = (self._gain.least / gain).tolist(), (self._gain.most / gain).tolist()
        for i in range(len(gain)):
            reading = None
            # A window longer than the belief is old holds what was before it.
            if contradicted[i] and (n == self._lengths[0] or self._age[i] >= n):
                evidence = Evidence(self._threshold, float(noise / gain[i]), (least[i], most[i]))
                reading = read_window(x[:, i], y[:, i], evidence, idle=not health.responsive[i])
                self._suspect[i] |= reading is None or reading.efficiency < 1.0
            settled = self._settled(i, n, reading)
            if settled is not None:
                self._follow(i, settled)

    def _settled(self, i: int, n: int, reading: WindowReading | None) -> WindowReading | None:
        """The reading, when it has been the same for long enough: at once without noise."""
        if self._noise == 0.0:
            return reading
        first, count = self._suggested.pop((i, n), (reading, 0))
        if reading is None:
            return None
        if first is None or not self._are_the_same(first, reading):
            first, count = reading, 0
        self._suggested[i, n] = first, count + 1
        return reading if count + 1 >= max(self._lengths[0], n // 2) else None

    def _are_the_same(self, one: WindowReading, other: WindowReading) -> bool:
        if np.isnan(one.stuck) or np.isnan(other.stuck):
            both = bool(np.isnan(one.stuck) and np.isnan(other.stuck))
            return both and abs(one.efficiency - other.efficiency) <= _SAME_EFFICIENCY
        return abs(one.stuck - other.stuck) <= self._threshold + self._noise

    def _follow(self, i: int, reading: WindowReading) -> None:
        efficiency, stuck, certain = reading
        before = self.health.efficiency[i], self.health.stuck[i]
        if not certain:
            self.doubtful[i] |= efficiency != before[0]
        elif efficiency != before[0] or not np.isnan(stuck) or not np.isnan(before[1]):
            self._believe(i, efficiency, stuck)

    def _believe(self, i: int, efficiency: float, stuck: float) -> None:
        self.health = self.health.with_thruster(i, efficiency, stuck)
        self._age[i] = 0
        for n in self._lengths:
            self._suggested.pop((i, n), None)


@compiled
def sound_pairs(efficiency, stuck, suspect, age, length):
    """(m,) bool: of which whole thrusters the oldest pair of forces is good to learn a gain from.

    Args:
        efficiency: (m,) believed share.
        stuck: (m,) force [N] believed to be held; NaN where none is.
        suspect: (m,) bool, which do not do what is believed of them.
        age: (m,) of what is believed [ticks].
        length: of the longest window [ticks]: an older pair is from before the belief.
    """
    sound = np.zeros(len(age), np.bool_)
    for i in range(len(age)):
        sound[i] = efficiency[i] == 1.0 and np.isnan(stuck[i]) and not suspect[i] and age[i] >= length
    return sound
