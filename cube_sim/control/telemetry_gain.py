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
from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Vector


class TelemetryGains(NamedTuple):
    """What is known of m gains.

    Attributes:
        xx: (m,) sum of the squares of the expected forces [N^2]; moved on, like the next four.
        xy: (m,) sum of the products of the expected and the measured ones [N^2].
        gain: (m,) the estimates, 1 at first.
        least: (m,) what they may be at least.
        most: (m,) what they may be at most.
        tolerance: how far from 1 a gain may be.
        unknown: sum of the squares [N^2] of what forces differ by for other reasons than gain and noise.
    """

    xx: Vector
    xy: Vector
    gain: Vector
    least: Vector
    most: Vector
    tolerance: float
    unknown: float


class TelemetryGain:
    """Estimates of m gains.

    Args:
        m: number of thrusters.
        tolerance: how far from 1 a gain may be.
        unknown: sum of the squares [N^2] of what forces differ by for other reasons than gain and noise.

    Attributes:
        gains: what is known of them.
    """

    def __init__(self, m: int, tolerance: float, unknown: float) -> None:
        least, most = np.full(m, 1.0 - tolerance), np.full(m, 1.0 + tolerance)
        self.gains = TelemetryGains(np.zeros(m), np.zeros(m), np.ones(m), least, most, float(tolerance), float(unknown))


@compiled
def learn_gains(gains, expected, measured, whole, noise):
    """Take one more pair of forces of each thruster into account; w is the weight.

    Args:
        gains: `TelemetryGains`, moved on.
        expected: (m,) [N].
        measured: (m,) [N].
        whole: (m,) bool, whose pair this is good for.
        noise: standard deviation of a measured force [N].
    """
    g = gains
    if g.tolerance == 0.0:
        return
    lowest, highest = 1.0 - g.tolerance, 1.0 + g.tolerance
    weight = g.unknown + (2.0 * noise / g.tolerance) ** 2
    for i in range(len(g.gain)):
        if whole[i]:
            g.xx[i] += expected[i] * expected[i]
            g.xy[i] += expected[i] * measured[i]
        sum_xx = g.xx[i] + weight
        g.gain[i] = min(max((g.xy[i] + weight) / sum_xx, lowest), highest)
        uncertainty = 2.0 * g.tolerance * weight / sum_xx + 4.0 * noise / sqrt(sum_xx)
        g.least[i] = max(lowest, g.gain[i] - uncertainty)
        g.most[i] = min(highest, g.gain[i] + uncertainty)
