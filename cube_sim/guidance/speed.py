"""How fast to go at each point of a path."""

from __future__ import annotations

from itertools import pairwise
from math import hypot, inf, sqrt
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cube_sim.guidance.bisection import count_up_to
from cube_sim.guidance.path import Path
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record

Array = NDArray[np.float64]

SAMPLES = 32
"""How many times a planned profile samples the curvature between two edges of a path."""
MAX_SAMPLES = 100_000
"""Samples of a whole path beyond which there are fewer between two edges, at least `MIN_SAMPLES`."""
MIN_SAMPLES = 4
STRAIGHT = 1e-9
"""A curvature that is less counts as none [1/m]."""
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


PROFILE = np.dtype([("closed", np.bool_), ("length", np.float64), ("end", np.float64), ("time", np.float64)])
"""A profile as compiled laws read it, beside its nodes: whether the path is closed and its length [m]; where the speed
comes to rest [m], infinite for never, and the time in which [s]."""
Parts = tuple[Record, Array, Array]
"""Record, nodes s (n,) [m] and u_d^2 there (n,) [m^2/s^2]; beyond the nodes of an open path the speed is that of the
last one. A profile that has `parts` is read inside compiled laws."""


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
        self.least = self.most = speed
        self.parts: Parts = (_never_ending(False, 1.0), np.array([0.0, 1.0]), np.full(2, speed * speed))

    def at(self, s: float) -> Speed:
        """The same everywhere."""
        return Speed(*speed_at(*self.parts, s))


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
        parts: Parts | None = getattr(profile, "parts", None)
        if parts is not None:
            record = parts[0].copy()
            record["end"], record["time"] = end, time
            self.parts: Parts = (record, *parts[1:])

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
        at, square = (np.ascontiguousarray(column) for column in nodes.T)
        self.least, self.most = sqrt(min(square)), sqrt(max(square))
        self.parts: Parts = (_never_ending(path.closed, path.length), at, square)

    def at(self, s: float) -> Speed:
        """The speed at arc length s [m]; beyond the ends of an open path that of the end."""
        return Speed(*speed_at(*self.parts, s))


def _never_ending(closed: bool, length: float) -> Record:
    return np.array([(closed, length, inf, 1.0)], PROFILE)


@compiled
def speed_at(profile, nodes, square, s):
    """The speed [m/s] at arc length s [m] and its slope [1/s]; arguments as in `Parts`."""
    p = profile[0]
    if s >= p.end:
        return 0.0, 0.0
    x = s % p.length if p.closed else s
    if not p.closed and not nodes[0] <= x <= nodes[-1]:
        value, slope = sqrt(square[0] if x < nodes[0] else square[-1]), 0.0
    else:
        i = min(count_up_to(nodes, x), len(nodes) - 1) - 1
        rise = (square[i + 1] - square[i]) / (nodes[i + 1] - nodes[i])
        value = sqrt(square[i] + rise * (x - nodes[i]))
        slope = rise / (2.0 * value)
    last = (p.end - s) / p.time
    if value > last:
        value, slope = last, -1.0 / p.time
    return value, slope


def tightest_radius(path: Path) -> float:
    """The smallest radius of curvature of a path [m]; infinite where it is straight, or a point."""
    if path.length <= 0.0:
        return inf
    largest = float(np.max(_sampled_curvature(path, 0.0)[1]))
    return 1.0 / largest if largest > STRAIGHT else inf


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
