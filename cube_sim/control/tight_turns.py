"""Turns of a path that a hull its fins steer does not make, for the water that carries it.

A path's curvature is over ground. With the current behind it such a hull keeps its way on through the water and is
carried round faster; across a current, slower through the water, its nose has more to turn and its fins make less.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from cube_sim.control.course_keeping import CourseKeeping
from cube_sim.control.steering_by_fins import FASTEST, SLOWEST, velocity_through_water
from cube_sim.guidance.path import Path
from cube_sim.spatial import Vector

STATIONS, MOST_STATIONS = 8, 20_000
"""Between two edges of a path, and on all of it (choices)."""
SHORT = 1e-3
"""Share of the way between two edges over which it is told how the course turns."""


class TightTurn(NamedTuple):
    """Where a path turns fastest beside what fins hold.

    Attributes:
        times: the rate wanted in that which is asked for at most at the flow there.
        distance_m: along the path.
        current_m_s: (3,) of the water in which it does, world axes.
    """

    times: float
    distance_m: float
    current_m_s: Vector


def tightest_turn(keeping: CourseKeeping, path: Path, current_m_s: Vector) -> TightTurn:
    """The tightest turn of a path in one current.

    Args:
        keeping: how fast the vehicle turns at its speed.
        path: the path.
        current_m_s: (3,) world axes.
    """
    tightest = TightTurn(0.0, 0.0, current_m_s)
    between = max(1, min(STATIONS, MOST_STATIONS // len(path.edges)))
    for first, last in pairwise(path.edges):
        step = SHORT * (last - first)
        for s in np.linspace(first, last - step, between):
            times = _times(keeping, path, float(s), float(step), current_m_s)
            if times > tightest.times:
                tightest = TightTurn(times, float(s), current_m_s)
    return tightest


def _times(keeping: CourseKeeping, path: Path, s: float, step: float, current: Vector) -> float:
    """The rate wanted at an arc length in the most that is asked for."""
    here, there = (_course(keeping.speed, path.at(at).rotation[:, 0], current) for at in (s, s + step))
    (pitch, heading, fast, along), (pitch_on, heading_on, _, _) = here, there
    turned = (heading_on - heading + np.pi) % (2.0 * np.pi) - np.pi
    rates = np.abs([pitch_on - pitch, turned * np.cos(pitch)]) * max(along, 0.0) / step
    share = min(max(fast / keeping.speed, SLOWEST), FASTEST)
    return float(np.max(rates / (share * keeping.most_rate)))


def _course(speed: float, T: Vector, current: Vector) -> tuple[float, float, float, float]:
    """Pitch and heading of the velocity through the water [rad], its size, and the speed along the path [m/s]."""
    through = np.array(velocity_through_water(tuple((speed * T).tolist()), tuple(current.tolist()), False))
    flat = float(np.hypot(through[0], through[1]))
    pitch, heading = np.arctan2(through[2], flat), np.arctan2(through[1], through[0])
    return float(pitch), float(heading), float(np.linalg.norm(through)), float((through + current) @ T)
