"""The curve a scenario's `path` block describes, and the speed along it."""

from __future__ import annotations

from math import inf, radians
from pathlib import Path as FilePath
from typing import assert_never

import numpy as np

from cube_sim.errors import PathError, ScenarioError
from cube_sim.guidance.arc import arc_through, circle
from cube_sim.guidance.helix import Helix
from cube_sim.guidance.line import Line
from cube_sim.guidance.path import Path
from cube_sim.guidance.point import Point
from cube_sim.guidance.polyline import polyline
from cube_sim.guidance.sinusoid import sinusoid
from cube_sim.guidance.speed import ConstantSpeed, PlannedSpeed, SpeedProfile
from cube_sim.guidance.spline import spline
from cube_sim.guidance.waypoints_csv import read_waypoints
from cube_sim.mission.own.code import NO_CODES, Codes
from cube_sim.mission.own.path import own_path
from cube_sim.scenario import Loaded
from cube_sim.scenario import path_blocks as blocks
from cube_sim.scenario.schema import GuidanceBlock

LEVEL = 1e-6
"""Largest slope of a level path."""


def path_of(loaded: Loaded, codes: Codes = NO_CODES) -> Path:
    """The path of a loaded scenario.

    Args:
        loaded: it.
        codes: code of the user's own.

    Raises:
        ScenarioError: what only building it shows, such as a spline with a cusp; with position.
    """
    block = loaded.scenario.path
    if isinstance(block, blocks.PythonPathBlock):
        return own_path(loaded, codes["path"], block)
    try:
        return make_path(block)
    except PathError as error:
        raise ScenarioError([loaded.mistake("path", str(error))]) from None


def make_path(block: blocks.NamedPath) -> Path:
    """The curve of one block.

    Raises:
        PathError: the block describes no path.
    """
    match block:
        case blocks.LineBlock():
            return Line(block.start_m, block.end_m)
        case blocks.PointBlock():
            return Point(block.position_m, radians(block.heading_deg))
        case blocks.ArcBlock():
            return arc_through(block.start_m, block.through_m, block.end_m)
        case blocks.CircleBlock():
            return circle(
                block.centre_m,
                block.radius_m,
                block.axis,
                radians(block.start_angle_deg),
                clockwise=block.direction == "right",
            )
        case blocks.HelixBlock():
            return Helix(
                block.centre_m,
                block.radius_m,
                block.pitch_m,
                block.turns,
                radians(block.start_angle_deg),
                clockwise=block.direction == "right",
            )
        case blocks.SinusoidBlock():
            return sinusoid(
                block.start_m, block.amplitude_m, block.wavelength_m, block.periods, radians(block.heading_deg)
            )
        case blocks.PolylineBlock():
            return polyline(block.points_m, block.corner_radius_m, block.closed)
        case blocks.SplineBlock():
            return spline(block.points_m, block.closed)
        case blocks.CsvBlock():
            points, _ = read_waypoints(FilePath(block.file))
            if block.corner_radius_m is None:
                return spline(points, block.closed)
            return polyline(points, block.corner_radius_m, block.closed)
        case _:
            assert_never(block)


def laps_of(block: blocks.AnyPath) -> float:
    """How many times the virtual target runs round a closed path; infinite where the scenario gives no number.

    A block without the key `laps` runs once.
    """
    laps: float | None = getattr(block, "laps", 1.0)
    return inf if laps is None else laps


def is_level(path: Path) -> bool:
    """Whether the path stays at one depth."""
    edges = np.asarray(path.edges)
    # a curve without corners shows in the first, a corner between long legs in the others
    stations = np.concatenate([np.linspace(0.0, path.length, 501), edges, 0.5 * (edges[1:] + edges[:-1])])
    return all(abs(path.at(s).rotation[2, 0]) < LEVEL for s in stations)


def speed_of(guidance: GuidanceBlock, path: Path) -> SpeedProfile:
    """The desired speed along a path."""
    if guidance.lateral_acceleration_m_s2 is None or not path.length:
        return ConstantSpeed(guidance.speed_m_s)
    return PlannedSpeed(path, guidance.speed_m_s, guidance.lateral_acceleration_m_s2, guidance.along_acceleration_m_s2)
