"""The angle under which the vehicle approaches its path."""

from __future__ import annotations

from math import tanh
from typing import NamedTuple

from cube_sim.native.compiled import compiled


class Angle(NamedTuple):
    """delta and its derivatives with respect to y1.

    Attributes:
        value: delta [rad].
        slope: d delta / d y1 [rad/m].
        bend: d^2 delta / d y1^2 [rad/m^2].
    """

    value: float
    slope: float
    bend: float


class ApproachAngle(NamedTuple):
    """delta(y1) = -psi_a tanh(k_delta y1).

    The literature writes the same with exponentials, which overflow far from the path.

    Attributes:
        psi_a: angle far from the path [rad], in (0, pi/2).
        k_delta: [1/m].
    """

    psi_a: float
    k_delta: float

    def at(self, y1: float) -> Angle:
        """The angle at y1 [m] to the left of the path."""
        return approach_angle.py_func(self, y1)


@compiled
def approach_angle(law, y1):
    """The `Angle` at y1 [m] to the left of the path.

    Args:
        law: whose psi_a and k_delta they are, an `ApproachAngle` or the law that has one.
        y1: [m].
    """
    t = tanh(law.k_delta * y1)
    slope = -law.psi_a * law.k_delta * (1.0 - t * t)
    return Angle(-law.psi_a * t, slope, -2.0 * law.k_delta * t * slope)
