"""The speed along a path, lowered where a planar hull cannot turn as the path does."""

from __future__ import annotations

from itertools import pairwise
from math import hypot

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.planar.attainable_set import PlanarAttainableSet
from cube_sim.control.planar.model import PlanarModel
from cube_sim.control.planar.turning import turning_length, turning_speed
from cube_sim.control.planar.turning_profile import TurningSpeed
from cube_sim.guidance.path import Path
from cube_sim.guidance.speed import PlannedSpeed, SpeedProfile
from cube_sim.scenario.schema import GuidanceBlock

SAMPLES = 16
"""Curvatures looked at between two edges of a path, and kinds of curve told apart on all of it."""


def flyable_speed(
    wanted: SpeedProfile, guidance: GuidanceBlock, path: Path, model: PlanarModel, attainable: PlanarAttainableSet
) -> SpeedProfile:
    """The wanted profile, or where the thrusters cannot keep it in a curve, one that they can.

    Of a curve counts how tight it is, and how fast it tightens or opens (`turning_length`). u_d^2 times that is bounded
    by its least value among the curves that have to be slower, with the braking planned ahead (`PlannedSpeed`).
    Thrusters and drag are those of the hull as known, in still water, none dead.

    Args:
        wanted: what the scenario asks for.
        guidance: the block that says so.
        path: the path.
        model: the controller's knowledge of the hull.
        attainable: what its thrusters can make.
    """
    straight = turning_speed(model, attainable, 0.0, guidance.speed_m_s)
    length = min(turning_length(model, straight), path.length)
    allowed = [(c + length * dc, turning_speed(model, attainable, c, straight, dc)) for c, dc in _curves(path, length)]
    slowest = min(u for _, u in allowed)
    if slowest >= guidance.speed_m_s:
        return wanted
    lateral = [counts * u * u for counts, u in allowed if u < straight]
    if guidance.lateral_acceleration_m_s2 is not None:
        lateral.append(guidance.lateral_acceleration_m_s2)
    bound = min(lateral) if lateral else straight**2 * max(counts for counts, _ in allowed) + 1.0  # straight is slow
    planned = PlannedSpeed(path, straight, bound, guidance.along_acceleration_m_s2, length)
    return TurningSpeed(wanted, planned, slowest)


def _curves(path: Path, length: float) -> NDArray[np.float64]:
    """Curvature [1/m] and change of it [1/m^2] (n, 2) of the kinds of curve on the path, the tightest among them.

    Args:
        path: the path.
        length: by which a change of curvature counts as curvature [m].
    """
    shares = np.linspace(0.0, 1.0, SAMPLES, endpoint=False)
    stations = np.concatenate([first + (last - first) * shares for first, last in pairwise(path.edges)])
    points = [path.at(s) for s in (*stations, path.length)]
    found = np.array([(hypot(*point.curvature), hypot(*point.curvature_rate)) for point in points])
    order = np.argsort(found @ (1.0, length), kind="stable")
    kinds = np.linspace(0, len(order) - 1, SAMPLES + 1).round().astype(int)
    return np.unique(found[order[kinds]], axis=0)
