"""A path of the user's own, whose points are looked at."""

from __future__ import annotations

from collections.abc import Sequence
from inspect import isclass
from typing import Any

import numpy as np

from cube_sim.errors import ScenarioError
from cube_sim.guidance.path import Path, PathPoint
from cube_sim.guidance.tabulated import TabulatedPath
from cube_sim.mission.own.code import OwnCode, made, numbers_of, refused
from cube_sim.scenario import Loaded
from cube_sim.scenario.check_blocks import PathEndCheckBlock
from cube_sim.scenario.path_blocks import PythonPathBlock

STATIONS = 101
"""Places at which a path is looked at before it is flown."""
STEP = 1e-4
"""Step along the path, part of its length, by which its tangent is compared."""
LARGEST_BEND = 0.05
"""Angle between tangent and step up to which they agree [rad]."""
ROUNDING = 1e-6
"""Of a rotation matrix."""


class OwnPath:
    """A `Path` that hands on the user's, point by point.

    Args:
        code: where it comes from.
        path: it.

    Raises:
        OwnCodeError: its length, its edges or its being closed are none.
    """

    def __init__(self, code: OwnCode, path: Any) -> None:
        for name in ("length", "closed", "edges", "at"):
            if not hasattr(path, name):
                raise code.refuse(f"makes a {type(path).__name__} without {name}; it takes a Path")
        self._code, self._path = code, path
        self.length = float(numbers_of(code, path.length, (), "the length"))
        self.closed = bool(path.closed)
        edges = numbers_of(code, path.edges, (len(path.edges),), "the edges")
        if not self.length >= 0.0 or len(edges) < 2 or edges[0] != 0.0 or np.any(np.diff(edges) < 0.0):
            raise code.refuse(f"has a length of {self.length:g} m and edges {edges}; these rise from 0 to the length")
        if abs(edges[-1] - self.length) > ROUNDING * (1.0 + self.length):
            raise code.refuse(f"has its last edge at {edges[-1]:g} m, its length is {self.length:g} m")
        self.edges: Sequence[float] = tuple(edges.tolist())

    def at(self, s: float) -> PathPoint:
        """See `Path.at`."""
        answer = self._code.call(self._path.at, s)
        if not isinstance(answer, tuple | list) or len(answer) != len(PathPoint._fields):
            text = f"answers a {type(answer).__name__} at s = {s:g} m; it takes a PathPoint"
            raise self._code.refuse(text)
        position, rotation, curvature, curvature_rate = answer
        where = f"at s = {s:g} m"
        k1, k2 = numbers_of(self._code, curvature, (2,), f"{where} the curvature").tolist()
        dk1, dk2 = numbers_of(self._code, curvature_rate, (2,), f"{where} the curvature's rate").tolist()
        return PathPoint(
            numbers_of(self._code, position, (3,), f"{where} the position"),
            numbers_of(self._code, rotation, (3, 3), f"{where} the rotation"),
            (k1, k2),
            (dk1, dk2),
        )


def own_path(loaded: Loaded, code: OwnCode, block: PythonPathBlock) -> Path:
    """The path a factory makes, or the one a program hands over.

    Raises:
        ScenarioError: it is none, or does not go with its laps; with position.
    """
    with refused(loaded):
        ready = hasattr(code.make, "at") and not isclass(code.make)
        given: Any = code.make if ready else made(loaded, code)
        path: Path = OwnPath(code, given)
        _require_frames(code, path)
        if type(given) is TabulatedPath:
            path = given  # it asks no code of the user's any more
    if block.laps is not None and not path.closed:
        raise ScenarioError([loaded.mistake("path.laps", "an open path has no laps")])
    if block.laps is None and path.closed:
        for index, check in enumerate(loaded.scenario.checks):
            if isinstance(check, PathEndCheckBlock):
                text = "a closed path run without end has no end to reach: give path.laps"
                raise ScenarioError([loaded.mistake(f"checks.{index}.kind", text)])
    return path


def _require_frames(code: OwnCode, path: Path) -> None:
    """Look at the path all along: frames are rotations, and their first axes point along it."""
    h = STEP * path.length
    for s in np.linspace(0.0, path.length, STATIONS).tolist():
        here = path.at(s)
        if not np.allclose(here.rotation @ here.rotation.T, np.eye(3), atol=ROUNDING) or (
            np.linalg.det(here.rotation) < 0.0
        ):
            raise code.refuse(f"has at s = {s:g} m a frame that is no rotation: its columns are T, N1, N2")
        first = min(s, path.length - h)
        step = path.at(first + h).position - path.at(first).position
        if h and not np.linalg.norm(step / h - path.at(first + 0.5 * h).rotation[:, 0]) <= LARGEST_BEND:
            text = f"goes {np.linalg.norm(step) / h:.3g} m in a metre at s = {first:g} m, or not along its T"
            raise code.refuse(f"{text}: s is its arc length, T its unit tangent")
