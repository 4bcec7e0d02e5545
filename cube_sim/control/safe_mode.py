"""What a vehicle does when it cannot follow its path any longer: hold where it is, or surface."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, hypot

import numpy as np

from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.spatial import State, Vector, quaternion_from_euler

NEARER = 0.01
"""Share of the distance limit by which a vehicle far off has to come nearer within its patience (a choice)."""


@dataclass(frozen=True)
class SafeMode:
    """When to give a path up, and what to do then.

    Attributes:
        surface: height to rise to [m], world axes; None to hold position.
        speed: bound on the velocity asked for [m/s].
        time: in which the distance to the place shrinks by 63 % [s].
        limit: distance from the target on the path [m] beyond which it is given up; infinite for never.
        patience: how long the vehicle has to be beyond the limit without coming nearer [s].
    """

    surface: float | None = None
    speed: float = 0.2
    time: float = 5.0
    limit: float = np.inf
    patience: float = 10.0


class SafeModeGoal:
    """Where a vehicle in safe mode goes: the place and heading at which it gave up, or the surface above it.

    Args:
        mode: what to do.
        state: of the vehicle when it gives up.
        reason: why, for the log.
    """

    def __init__(self, mode: SafeMode, state: State, reason: str) -> None:
        self._mode = mode
        self._place = state.position.copy()
        self._does = "it holds its position as well as it can"
        if mode.surface is not None:
            above = float(self._place[2]) - mode.surface
            self._does = "it makes for the surface" + (f", {above:.2g} m below it" if above > 0.0 else "")
            self._place[2] = mode.surface
        ahead = state.rotation[:, 0]
        self.attitude = FixedAttitude(quaternion_from_euler(0.0, 0.0, atan2(ahead[1], ahead[0])))
        self.set_reason(reason)

    def set_reason(self, reason: str) -> None:
        """Say why the path is given up; what the vehicle does instead is added."""
        self.reason = f"{reason}; {self._does}"

    def motion(self, position: Vector) -> DesiredMotion:
        """Towards the place, never faster than the mode's speed."""
        velocity = (self._place - position) / self._mode.time
        speed = float(np.linalg.norm(velocity))
        return DesiredMotion(velocity * min(1.0, self._mode.speed / max(speed, 1e-12)), np.zeros(3))


class LossOfTargetMonitor:
    """Detects that a vehicle has lost its target: beyond the limit, and no nearer than before, for the patience.

    It counts only after the vehicle has been within the limit once, so a start from far away is no loss. Neither is it
    one to take the path up again from far away, as long as the vehicle comes nearer.
    """

    def __init__(self, mode: SafeMode) -> None:
        self._mode, self._was_near = mode, False
        self.restart()

    def restart(self) -> None:
        """Begin to count anew, from where the vehicle takes its path up again."""
        self._since, self._nearest = 0.0, np.inf

    def reason(self, view: TargetView, dt: float) -> str:
        """Why the path is given up, "" if it is not; to be asked at every tick."""
        distance, limit = hypot(*view.error.tolist()), self._mode.limit
        if distance <= limit:
            self._was_near, self._since, self._nearest = True, 0.0, distance
        elif distance <= self._nearest - NEARER * limit:
            self._since, self._nearest = 0.0, distance
        elif self._was_near:
            self._since += dt
        if self._since < self._mode.patience:
            return ""
        return f"{distance:.1f} m from its target on the path, beyond {limit:g} m for {self._mode.patience:g} s"
