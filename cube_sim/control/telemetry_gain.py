"""The gain of each thruster's telemetry, learned while the thruster is whole.

A motor's speed and current give its thruster's force to some percent, always the same way. While the thruster is whole
the force expected of it shows the gain: least squares over all that was expected and measured, x and y,

    g = (sum x y + w) / (sum x^2 + w),  held within 1 +- tolerance.

The weight w is the prior's: 1 with half the tolerance as its standard deviation. What is left uncertain shrinks as
sum x^2 grows. A thruster that is whole but for less than the tolerance cannot be told
from one whose telemetry reads that much less.
"""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Vector


class TelemetryGain:
    """Estimates of m gains.

    Args:
        m: number of thrusters.
        tolerance: how far from 1 a gain may be.
        unknown: sum of the squares [N^2] of what forces differ by for other reasons than gain and noise.

    Attributes:
        gain: (m,) the estimates, 1 at first.
        least: (m,) what they may be at least.
        most: (m,) what they may be at most.
    """

    def __init__(self, m: int, tolerance: float, unknown: float) -> None:
        self._tolerance, self._unknown = tolerance, unknown
        self._xx, self._xy = np.zeros(m), np.zeros(m)
        self.gain = np.ones(m)
        self.least, self.most = np.full(m, 1.0 - tolerance), np.full(m, 1.0 + tolerance)

    def learn(self, expected: Vector, measured: Vector, whole: np.ndarray, noise: float) -> None:
        """Take one more pair of forces into account.

        Args:
            expected: (m,) [N].
            measured: (m,) [N].
            whole: (m,) bool, whose pair this is good for.
            noise: standard deviation of a measured force [N].
        """
        if self._tolerance == 0.0:
            return
        x = np.where(whole, expected, 0.0)
        self._xx += x * x
        self._xy += x * measured
        least, most = 1.0 - self._tolerance, 1.0 + self._tolerance
        weight = self._unknown + (2.0 * noise / self._tolerance) ** 2
        xx = self._xx + weight
        self.gain = np.clip((self._xy + weight) / xx, least, most)
        uncertainty = 2.0 * self._tolerance * weight / xx + 4.0 * noise / np.sqrt(xx)
        self.least = np.maximum(least, self.gain - uncertainty)
        self.most = np.minimum(most, self.gain + uncertainty)
