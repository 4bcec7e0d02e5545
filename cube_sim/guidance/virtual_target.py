"""The virtual target: a point that runs along the path at a speed of its own choosing."""

from __future__ import annotations

from math import inf

import numpy as np

from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import Path
from cube_sim.guidance.path_record import path_numbers
from cube_sim.guidance.target_record import NO_PLAN, RunningParts, advanced, see_from_target, virtual
from cube_sim.guidance.view_record import VIEW, view_of
from cube_sim.spatial import Record, Vector


class VirtualTarget:
    """s' = v_T + k2 s1, saturated and kept on the path.

    With V = |e|^2 / 2 the curvature terms of the error dynamics cancel: V' = s1 (v_T - s') + y1 v_1 + z1 v_2. This
    choice leaves V' = -k2 s1^2 plus the lateral part, whatever the curvature and however large the initial error.
    Nothing is divided by 1 - k1 y1 - k2 z1 (the 3-D form of Lapierre and Soetanto 2007, Ocean Eng. 34, equation 5).

    Args:
        path: what to run along.
        gain: k2 [1/s].
        speed_limit: bound on |s'| [m/s].
        arc_length: where to start [m].
        laps: how many times a closed path is run round; it has no beginning, so the target may also run backwards.
    """

    def __init__(
        self, path: Path, gain: float, speed_limit: float = inf, arc_length: float = 0.0, laps: float = inf
    ) -> None:
        self._path = path
        first, last = -inf if path.closed else 0.0, path.length * (laps if path.closed else 1.0)
        self.parts: RunningParts = virtual(gain, speed_limit, first, last), NO_PLAN
        self.arc_length = arc_length

    @property
    def path(self) -> Path:
        """What it runs along."""
        return self._path

    def seen(self, position: Vector, velocity_W: Vector) -> Record:
        """`view` as compiled laws read it, (1,) of `cube_sim.guidance.view_record.VIEW`."""
        view, s = np.zeros(1, VIEW), self.arc_length
        see_from_target(view, self.parts[0], path_numbers(self._path, s), 0.0, s, position, velocity_W)
        return view

    def view(self, position: Vector, velocity_W: Vector) -> TargetView:
        """The vehicle in the target's frame, and the target's speed that follows.

        Args:
            position: p_WB (3,) [m].
            velocity_W: velocity over ground (3,) [m/s], world axes.
        """
        return view_of(self.seen(position, velocity_W))

    def advance(self, speed: float, dt: float) -> None:
        """Move the target for dt [s] at s' = speed [m/s], never past an end of its run."""
        self.arc_length = advanced(self.parts[0], 0.0, self.arc_length, speed, dt)
