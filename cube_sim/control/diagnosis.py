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

Nothing that works gives a steady force far beyond what is expected of it, or against it. So a thruster that sticks at a
large force is known after the last few readings.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.probing import ProbeMemory, Probes
from cube_sim.control.telemetry_gain import TelemetryGain, TelemetryGains, learn_gains
from cube_sim.control.window_reading import Evidence, WindowReading, contradicts, read_at_once, read_window
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.wrench.health import Health

_LENGTHS = (1, 4, 16)
"""Lengths of the windows under noise, in lengths of the first."""
AT_ONCE_S, AT_ONCE_TICKS = 0.1, 4
"""The readings that show a thruster stuck at a large force: of so long [s], and so many at least."""
_SAME_EFFICIENCY = 0.1
"""Readings of an efficiency that differ by less are the same."""


class Window(NamedTuple):
    """The forces of the last ticks, and what they are held against.

    Attributes:
        expected: (k,m) [N], a ring of rows.
        measured: (k,m) [N], likewise.
        ring: (2,) the next row, and how many are filled.
        age: (m,) of what is believed [ticks].
        suspect: (m,) bool, which do not do what is believed of them.
        efficiency: (m,) believed share.
        stuck: (m,) force [N] believed to be held; NaN where none is.
        threshold: differences below this say nothing [N].
        noise: standard deviation of a measured force [N].
        gains: what is known of the telemetry.
        lengths: (l,) of the windows that are looked at [ticks], the last one k.
    """

    expected: Matrix
    measured: Matrix
    ring: NDArray[np.int64]
    age: NDArray[np.int_]
    suspect: NDArray[np.bool_]
    efficiency: Vector
    stuck: Vector
    threshold: float
    noise: float
    gains: TelemetryGains
    lengths: NDArray[np.int64]


class Diagnosis:
    """A running judgement of m thrusters.

    Args:
        window_s: length of the window [s]: the time a fault has to last to be believed.
        threshold_N: forces and differences below this say nothing [N].
        dt: control period [s].
        probe_N: (m,) what silent thrusters are asked for [N], well beyond the threshold.
        noise_N: standard deviation of a measured force [N], white.
        gain_tolerance: how far from 1 the gain of a measured force may be.
        probe_s: the most a probe takes [s]: so long that a whole thruster has answered.

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
        probe_s: float = 0.3,
    ) -> None:
        n, m = max(2, round(window_s / dt)), len(probe_N)
        self._threshold, self._noise = threshold_N, noise_N
        self._lengths = tuple(n * k for k in _LENGTHS) if noise_N > 0.0 else (n,)
        self._at_once = min(n, max(AT_ONCE_TICKS, round(AT_ONCE_S / dt)))
        self._expected, self._measured = np.zeros((self._lengths[-1], m)), np.zeros((self._lengths[-1], m))
        self._ring = np.zeros(2, dtype=np.int64)
        self._gain = TelemetryGain(m, gain_tolerance, n * threshold_N**2)
        self._suspect = np.zeros(m, dtype=bool)
        self._suggested: dict[tuple[int, int], tuple[WindowReading, int]] = {}
        self._age = np.full(m, self._lengths[-1])
        self._probes = Probes(probe_N, dt, length_s=probe_s)
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
        enter_pair(self._window, expected, measured, force_ratio)
        return self.conclude(force_ratio)

    def conclude(self, force_ratio: float) -> Health:
        """Judge the pair of forces that `enter_pair` has entered into the window last."""
        self.doubtful = np.zeros(len(self._age), dtype=bool)
        for n in self._lengths:
            if self._ring[1] >= n:
                self._judge(n, self._noise / force_ratio)
        return self.health

    @property
    def window(self) -> Window | None:
        """What it judges by while nothing speaks against what is believed; None where something does."""
        return None if self._suggested or self.doubtful.any() else self._window

    @property
    def probes(self) -> ProbeMemory:
        """What thrusters are probed by."""
        return self._probes.memory

    @property
    def _window(self) -> Window:
        rings, health = (self._expected, self._measured, self._ring, self._age, self._suspect), self.health
        lengths = np.array(self._lengths, dtype=np.int64)
        return Window(*rings, *health, self._threshold, float(self._noise), self._gain.gains, lengths)

    def _judge(self, n: int, noise: float) -> None:
        """Believe something else of thrusters that do not do what is believed of them, if n ticks say what."""
        gain, health = self._gain.gains.gain, self.health
        first = int(self._ring[0] - n) % len(self._expected)
        contradicted = contradicts(
            self._expected, self._measured, first, n, *health, gain, self._threshold, float(noise)
        )
        if not (contradicted.any() or self._suggested):
            return
        newest = (first + np.arange(n)) % len(self._expected)
        x, y = self._expected[newest], self._measured[newest] / gain
        least, most = (self._gain.gains.least / gain).tolist(), (self._gain.gains.most / gain).tolist()
        for i in range(len(gain)):
            reading = None
            # A window longer than the belief is old holds what was before it.
            if contradicted[i] and (n == self._lengths[0] or self._age[i] >= n):
                evidence = Evidence(self._threshold, float(noise / gain[i]), (least[i], most[i]))
                last = x[-self._at_once :, i], y[-self._at_once :, i]
                if n == self._lengths[0] and (stuck := read_at_once(*last, evidence)) is not None:
                    self._follow_at_once(i, stuck, noise)
                    continue
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

    def _follow_at_once(self, i: int, reading: WindowReading, noise: float) -> None:
        """Believe that it is stuck there, unless that is what is believed."""
        self._suspect[i] = True
        if not abs(reading.stuck - self.health.stuck[i]) <= self._threshold + 2.0 * noise:
            self._believe(i, reading.efficiency, reading.stuck)

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


@compiled
def enter_pair(window, expected, measured, force_ratio):
    """Put a pair of forces in the place of the oldest, of which the gains of the telemetry are learned.

    Args:
        window: `Window`, moved on.
        expected: (m,) [N], at the voltage of the characteristics.
        measured: (m,) [N].
        force_ratio: the share of their force that the supply leaves the thrusters.
    """
    w, rows, row = window, len(window.expected), window.ring[0]
    if w.ring[1] == rows:
        sound = sound_pairs(w.efficiency, w.stuck, w.suspect, w.age, rows)
        learn_gains(w.gains, w.expected[row], w.measured[row], sound, w.noise / force_ratio)
    for i in range(len(w.age)):
        w.expected[row, i], w.measured[row, i] = expected[i], measured[i] / force_ratio
        w.age[i] += 1
        w.suspect[i] = False
    w.ring[0], w.ring[1] = (row + 1) % rows, min(w.ring[1] + 1, rows)


@compiled
def speaks_against(window, force_ratio):
    """Whether a window of any length says that a thruster does something else than believed.

    Args:
        window: `Window`, the forces of this tick entered.
        force_ratio: the share of their force that the supply leaves the thrusters.
    """
    w, rows = window, len(window.expected)
    against = False
    for n in w.lengths:
        if w.ring[1] >= n and not against:
            first, noise = (w.ring[0] - n) % rows, w.noise / force_ratio
            believed = w.efficiency, w.stuck, w.gains.gain
            against = contradicts(w.expected, w.measured, first, n, *believed, w.threshold, noise).any()
    return against
