"""The target of trajectory tracking: a point that runs along the path by the clock, wherever the vehicle is."""

from __future__ import annotations

from math import inf

from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import Path, PathPoint
from cube_sim.guidance.speed import SpeedProfile
from cube_sim.spatial import Vector


class ClockedTarget:
    """s' = u_d(s).

    Where its speed does not end with the path it runs on along the last tangent.

    Args:
        path: what to run along.
        profile: u_d; with `StoppingSpeed` the run ends where the path does.
        laps: how many times a closed path is run round.
        arc_length: where to start [m].
    """

    def __init__(self, path: Path, profile: SpeedProfile, laps: float = inf, arc_length: float = 0.0) -> None:
        self._path, self._profile = path, profile
        self._last = path.length * (laps if path.closed else 1.0)
        self.arc_length = arc_length

    def view(self, position: Vector, velocity_W: Vector) -> TargetView:
        """The vehicle in the target's frame; the target's speed does not depend on it. `remaining` < 0 past the end.

        Args:
            position: p_WB (3,) [m].
            velocity_W: velocity over ground (3,) [m/s], world axes.
        """
        s = self.arc_length
        point = self._at(s)
        error = (position - point.position) @ point.rotation
        return TargetView(s, self._last - s, self._profile.at(s).value, point, error, velocity_W @ point.rotation)

    def advance(self, speed: float, dt: float) -> None:
        """Move on for dt [s]: two terms of the series of s(t), exact for a speed that changes evenly in time."""
        self.arc_length += dt * speed * (1.0 + 0.5 * dt * self._profile.at(self.arc_length).slope)

    def _at(self, s: float) -> PathPoint:
        if s <= self._last:
            return self._path.at(s)
        end = self._path.at(self._last)
        return PathPoint(end.position + (s - self._last) * end.rotation[:, 0], end.rotation, (0.0, 0.0), (0.0, 0.0))
