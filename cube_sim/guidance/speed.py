"""How fast to go at each point of a path."""

from __future__ import annotations

from math import ceil, sqrt
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cube_sim.guidance.path import Path

GRID = 0.02
"""Spacing of a planned profile [m], or a two-thousandth of the path where that is more."""


class Speed(NamedTuple):
    """A desired speed.

    Attributes:
        value: u_d [m/s], positive, or 0 where a run ends.
        slope: du_d/ds [1/s].
    """

    value: float
    slope: float


class SpeedProfile(Protocol):
    """Desired speed along a path as a function of its arc length alone."""

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]."""
        ...


class ConstantSpeed:
    """One speed [m/s] all along."""

    def __init__(self, speed: float) -> None:
        self._speed = Speed(speed, 0.0)

    def at(self, s: float) -> Speed:
        """The same everywhere."""
        return self._speed


class StoppingSpeed:
    """A profile that ends: the speed falls as the remaining length over T, and the end is approached like exp(-t / T).

    Args:
        profile: the speed before.
        end: arc length [m] where it comes to rest; infinite for never.
        time: T [s].
    """

    def __init__(self, profile: SpeedProfile, end: float, time: float) -> None:
        self._profile, self._end, self._time = profile, end, time

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]; 0 from the end on."""
        if s >= self._end:
            return Speed(0.0, 0.0)
        wanted, last = self._profile.at(s), (self._end - s) / self._time
        return wanted if wanted.value <= last else Speed(last, -1.0 / self._time)


class PlannedSpeed:
    """Slow in curves, with the braking planned ahead.

    The largest u_d with u_d <= speed, u_d^2 |curvature| <= lateral acceleration and |d(u_d^2)/ds| <= 2 acceleration: a
    point that runs along the path at u_d never accelerates along it by more than that. As the curvature is looked at on
    a grid, the bounds hold within 0.1 %. The profile is piecewise linear in u_d^2, found by one pass against the path
    and one along it (J. Bobrow et al. 1985, for robot arms), twice round a closed one.

    Args:
        path: the path.
        speed: where nothing asks for less [m/s].
        lateral_acceleration: bound on u_d^2 |curvature| [m/s^2].
        acceleration: bound on the speeding up and slowing down along the path [m/s^2].
    """

    def __init__(self, path: Path, speed: float, lateral_acceleration: float, acceleration: float) -> None:
        intervals = max(2, ceil(path.length / max(GRID, path.length / 2000.0)))
        s = np.linspace(0.0, path.length, intervals + 1)
        curvature = np.array([np.hypot(*path.at(at).curvature) for at in s])
        # what lies between two grid points is held to the tighter one, with both neighbours of each
        tightest = np.maximum(curvature, np.maximum(np.append(curvature[1:], 0.0), np.append(0.0, curvature[:-1])))
        square = np.minimum(speed**2, lateral_acceleration / np.maximum(tightest, lateral_acceleration / speed**2))
        self._step = path.length / intervals
        self._square = _within_slope(square, 2.0 * acceleration * self._step, path.closed)
        self._length, self._closed = path.length, path.closed

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]; beyond the ends of an open path that of the end."""
        if self._closed:
            s %= self._length
        elif not 0.0 <= s <= self._length:
            return Speed(sqrt(self._square[0 if s < 0.0 else -1]), 0.0)
        i = min(int(s / self._step), len(self._square) - 2)
        rise = (self._square[i + 1] - self._square[i]) / self._step
        value = sqrt(self._square[i] + rise * (s - i * self._step))
        return Speed(value, float(rise) / (2.0 * value))


def _within_slope(values: NDArray[np.float64], step: float, closed: bool) -> NDArray[np.float64]:
    """The largest sequence below `values` whose neighbours differ by at most `step`."""
    result = values.copy()
    for _ in range(2 if closed else 1):
        if closed:
            result[0] = result[-1] = min(result[0], result[-1])
        for i in range(len(result) - 2, -1, -1):
            result[i] = min(result[i], result[i + 1] + step)
        for i in range(1, len(result)):
            result[i] = min(result[i], result[i - 1] + step)
    return result
