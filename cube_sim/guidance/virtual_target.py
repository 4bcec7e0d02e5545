"""The virtual target: a point that runs along the path at a speed of its own choosing."""

from __future__ import annotations

from math import inf

import numpy as np

from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import Path
from cube_sim.guidance.path_record import path_numbers
from cube_sim.guidance.view_record import VIEW, see, view_of
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, Vector

TARGET = np.dtype([(name, np.float64) for name in ("gain", "speed_limit", "first", "last")])
"""Numbers of `VirtualTarget`: k2 [1/s], the bound on |s'| [m/s], and the arc lengths between which it runs [m]."""


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
        self.record: Record = np.array([(gain, speed_limit, first, last)], TARGET)
        self.arc_length = arc_length

    @property
    def path(self) -> Path:
        """What it runs along."""
        return self._path

    def seen(self, position: Vector, velocity_W: Vector) -> Record:
        """`view` as compiled laws read it, (1,) of `cube_sim.guidance.view_record.VIEW`."""
        view, s = np.zeros(1, VIEW), self.arc_length
        see_from_virtual_target(view, self.record, path_numbers(self._path, s), s, position, velocity_W)
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
        first, last = float(self.record["first"][0]), float(self.record["last"][0])
        self.arc_length = min(max(self.arc_length + speed * dt, first), last)


@compiled
def see_from_virtual_target(view, target, row, arc_length, position, velocity_W):
    """Fill a record `VIEW`.

    Args:
        view: filled.
        target: record `TARGET`.
        row: (16,) the path at the target.
        arc_length: of the target [m].
        position: p_WB (3,) [m].
        velocity_W: over ground (3,) [m/s], world axes.
    """
    t, w = target[0], view[0]
    see(view, row, arc_length, t.last - arc_length, position, velocity_W)
    speed = min(max(w.velocity[0] + t.gain * w.error[0], -t.speed_limit), t.speed_limit)
    if (arc_length <= t.first and speed < 0.0) or (arc_length >= t.last and speed > 0.0):
        speed = 0.0
    w.speed = speed
