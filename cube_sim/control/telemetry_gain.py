"""The gain of each thruster's telemetry, learned while the thruster is whole.

A motor's speed and current give its thruster's force to some percent, always the same way. While the thruster is whole
the force expected of it shows the gain: least squares over all that was expected and measured, x and y,

    g = (sum x y + w) / (sum x^2 + w),  held within 1 +- tolerance.

The weight w is the prior's: 1 with half the tolerance as its standard deviation. What is left uncertain shrinks as
sum x^2 grows. A thruster that is whole but for less than the tolerance cannot be told
from one whose telemetry reads that much less.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from cube_sim.native.compiled import compiled
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
        learn_gain(
            self._xx,
            self._xy,
            expected,
            measured,
            whole,
            self._tolerance,
            self._unknown + (2.0 * noise / self._tolerance) ** 2,
            float(noise),
            self.gain,
            self.least,
            self.most,
        )


@compiled
def learn_gain(xx, xy, expected, measured, whole, tolerance, weight, noise, gain, least, most):
    """Take one more pair of forces of each thruster into account; w is the weight."""
    lowest, highest = 1.0 - tolerance, 1.0 + tolerance
    for i in range(len(gain)):
        if whole[i]:
            xx[i] += expected[i] * expected[i]
            xy[i] += expected[i] * measured[i]
        sum_xx = xx[i] + weight
        gain[i] = min(max((xy[i] + weight) / sum_xx, lowest), highest)
        uncertainty = 2.0 * tolerance * weight / sum_xx + 4.0 * noise / sqrt(sum_xx)
        least[i] = max(lowest, gain[i] - uncertainty)
        most[i] = min(highest, gain[i] + uncertainty)
