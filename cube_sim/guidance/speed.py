"""How fast to go at each point of a path."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from math import hypot, inf, sqrt
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cube_sim.guidance.path import Path

Array = NDArray[np.float64]

SAMPLES = 32
"""How many times a planned profile samples the curvature between two edges of a path."""
MAX_SAMPLES = 100_000
"""Samples of a whole path beyond which there are fewer between two edges, at least `MIN_SAMPLES`."""
MIN_SAMPLES = 4
ALIKE = 1e-6
"""Share of itself by which a curvature may vary that counts as one."""


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

    @property
    def least(self) -> float:
        """The lowest speed anywhere [m/s]."""
        ...

    @property
    def most(self) -> float:
        """The highest speed anywhere [m/s]."""
        ...

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]."""
        ...


class ConstantSpeed:
    """One speed [m/s] all along."""

    def __init__(self, speed: float) -> None:
        self._speed = Speed(speed, 0.0)
        self.least = self.most = speed

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
        self.least = profile.least if end == inf else 0.0
        self.most = profile.most

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]; 0 from the end on."""
        if s >= self._end:
            return Speed(0.0, 0.0)
        wanted, last = self._profile.at(s), (self._end - s) / self._time
        return wanted if wanted.value <= last else Speed(last, -1.0 / self._time)


class PlannedSpeed:
    """Slow in curves, with the braking planned ahead.

    The largest u_d with u_d <= speed, u_d^2 |curvature| <= lateral acceleration and |d(u_d^2)/ds| <= 2 acceleration: a
    point that runs along the path at u_d never accelerates along it by more than that. The profile is piecewise linear
    in u_d^2: at each node it is the smallest of what the nodes around allow, plus 2 acceleration times the distance to
    them (the two passes of J. Bobrow et al. 1985, for robot arms), over the seam of a closed path too.

    The curvature is sampled `SAMPLES` times between any two edges of the path, so no corner is missed however long the
    legs, and u_d^2 |curvature| holds within 0.1 %. A path of more than `MAX_SAMPLES` / `SAMPLES` edges is sampled less
    often between them. With `MIN_SAMPLES` the bound holds within 1 %, and the speed may lie 5 % below what it allows.

    Args:
        path: the path.
        speed: where nothing asks for less [m/s].
        lateral_acceleration: bound on u_d^2 |curvature| [m/s^2].
        acceleration: bound on the speeding up and slowing down along the path [m/s^2].
        turning_length: L [m]: |curvature| + L |d curvature / ds| counts as the curvature, for a vehicle that takes
            torque to begin a turn.
    """

    def __init__(
        self,
        path: Path,
        speed: float,
        lateral_acceleration: float,
        acceleration: float,
        turning_length: float = 0.0,
    ) -> None:
        s, curvature = _sampled_curvature(path, turning_length)
        # u_d^2 allowed between two nodes, by the tighter one; at a node by the tighter of its two sides
        tighter = np.maximum(curvature[1:], curvature[:-1])
        between = np.minimum(speed**2, lateral_acceleration / np.maximum(tighter, lateral_acceleration / speed**2))
        first, last = (between[-1], between[0]) if path.closed else (inf, inf)
        allowed = np.minimum(np.append(between, last), np.append(first, between))
        slope = 2.0 * acceleration
        nodes = _peaks(s, _within_slope(s, allowed, slope, path.closed), between, slope)
        self._s, self._square = (column.tolist() for column in nodes.T)
        self.least, self.most = sqrt(min(self._square)), sqrt(max(self._square))
        self._length, self._closed = path.length, path.closed

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]; beyond the ends of an open path that of the end."""
        if self._closed:
            s %= self._length
        elif not 0.0 <= s <= self._length:
            return Speed(sqrt(self._square[0 if s < 0.0 else -1]), 0.0)
        i = min(bisect_right(self._s, s), len(self._s) - 1) - 1
        rise = (self._square[i + 1] - self._square[i]) / (self._s[i + 1] - self._s[i])
        value = sqrt(self._square[i] + rise * (s - self._s[i]))
        return Speed(value, rise / (2.0 * value))


def _sampled_curvature(path: Path, turning_length: float) -> tuple[Array, Array]:
    """Arc lengths (n,) [m] and what counts as curvature there (n,) [1/m], dense enough to show every corner."""
    edges = np.asarray(path.edges)
    shares = np.linspace(0.0, 1.0, min(SAMPLES, max(MIN_SAMPLES, MAX_SAMPLES // len(edges))) + 1)
    s: list[float] = [0.0]
    curvature: list[float] = [_curvature(path, 0.0, turning_length)]
    for first, last in pairwise(edges):
        among = first + (last - first) * shares[[1, len(shares) // 3, -2, -1]]
        few = [_curvature(path, at, turning_length) for at in among]
        one = max(*few, curvature[-1]) - min(*few, curvature[-1]) <= ALIKE * max(few)
        stations = [last] if one else first + (last - first) * shares[1:]
        s += list(stations)
        curvature += [few[-1]] if one else [_curvature(path, at, turning_length) for at in stations]
    return np.array(s), np.array(curvature)


def _curvature(path: Path, s: float, turning_length: float) -> float:
    point = path.at(s)
    return hypot(*point.curvature) + turning_length * hypot(*point.curvature_rate)


def _within_slope(s: Array, values: Array, slope: float, closed: bool) -> Array:
    """The largest function on the stations s that is nowhere above `values` and rises and falls by `slope` at most."""
    result, steps = values.tolist(), (slope * np.diff(s)).tolist()
    for _ in range(2 if closed else 1):
        if closed:
            result[0] = result[-1] = min(result[0], result[-1])
        for i in range(len(steps) - 1, -1, -1):
            result[i] = min(result[i], result[i + 1] + steps[i])
        for i, step in enumerate(steps, 1):
            result[i] = min(result[i], result[i - 1] + step)
    return np.array(result)


def _peaks(s: Array, square: Array, between: Array, slope: float) -> Array:
    """The nodes (n, 2) of s and u_d^2, and where it may rise higher between two of them the ones that make it do so.

    From both ends it rises by `slope`, to where the two meet or to what is allowed there.
    """
    width = np.diff(s)
    left, right = (between - square[:-1]) / slope, width - (between - square[1:]) / slope
    meeting = 0.5 * (width + (square[1:] - square[:-1]) / slope)
    top = np.where(left < meeting, between, np.minimum(between, square[:-1] + slope * meeting))
    left, right = np.minimum(left, meeting), np.maximum(right, meeting)
    new = np.concatenate([np.column_stack([s[:-1] + left, top]), np.column_stack([s[:-1] + right, top])])
    inside = (np.concatenate([left, right]) > 1e-9 * np.tile(width, 2)) & (
        np.concatenate([left, right]) < (1.0 - 1e-9) * np.tile(width, 2)
    )
    nodes = np.concatenate([np.column_stack([s, square]), new[inside]])
    return nodes[np.unique(nodes[:, 0], return_index=True)[1]]
