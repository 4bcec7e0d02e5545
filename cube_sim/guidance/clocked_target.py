"""The target of trajectory tracking: a point that runs along the path by the clock, wherever the vehicle is."""

from __future__ import annotations

from math import inf

import numpy as np

from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import Path
from cube_sim.guidance.path_record import path_numbers
from cube_sim.guidance.speed import SpeedProfile
from cube_sim.guidance.target_record import RunningParts, advanced, clocked, see_from_target
from cube_sim.guidance.view_record import VIEW, view_of
from cube_sim.spatial import Record, Vector


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
        self._record, planned = clocked(self._last), getattr(profile, "parts", None)
        self.parts: RunningParts | None = None if planned is None else (self._record, planned)
        self.arc_length = arc_length

    @property
    def path(self) -> Path:
        """What it runs along."""
        return self._path

    def seen(self, position: Vector, velocity_W: Vector) -> Record:
        """`view` as compiled laws read it, (1,) of `cube_sim.guidance.view_record.VIEW`."""
        view, s, last = np.zeros(1, VIEW), self.arc_length, self._last
        row, speed = path_numbers(self._path, min(s, last)), self._profile.at(s).value
        see_from_target(view, self._record, row, speed, s, position, velocity_W)
        return view

    def view(self, position: Vector, velocity_W: Vector) -> TargetView:
        """The vehicle in the target's frame; the target's speed does not depend on it. `remaining` < 0 past the end.

        Args:
            position: p_WB (3,) [m].
            velocity_W: velocity over ground (3,) [m/s], world axes.
        """
        return view_of(self.seen(position, velocity_W))

    def advance(self, speed: float, dt: float) -> None:
        """Move on for dt [s], starting at s' = speed [m/s]."""
        s = self.arc_length
        self.arc_length = advanced(self._record, self._profile.at(s).slope, s, speed, dt)
