"""What a vehicle does when it cannot follow its path any longer: hold where it is, or surface."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, sqrt

import numpy as np

from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, State, Vector, quaternion_from_euler

CLOSE_M, POINTING_M, CLOSE_S = 1.5, 4.0, 3.0
"""Limits and patience, where they are no less, of a vehicle that no attitude holds at rest beside what is stuck; the
second for one that points its thrust, which may be held as it turns round and round (choices)."""
AFLOAT_M, SUNK_M = 0.1, 1.0
"""A vehicle that floats lets its thrusters rest from so far below its draught on, and until it is so deep (choices)."""
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
        floats: whether the surface is that of the water, and the vehicle lies there by itself.
    """

    surface: float | None = None
    speed: float = 0.2
    time: float = 5.0
    limit: float = np.inf
    patience: float = 10.0
    floats: bool = False


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
        self._afloat = False
        ahead = state.rotation[:, 0]
        self.attitude = FixedAttitude(quaternion_from_euler(0.0, 0.0, atan2(ahead[1], ahead[0])))
        self.set_reason(reason)

    def set_reason(self, reason: str) -> None:
        """Say why the path is given up; what the vehicle does instead is added."""
        self._why = reason
        self.reason = f"{reason}; {self._does}"

    def say_left_alone(self, alone: bool) -> None:
        """Say that the thrusters that work are off from now on, or are tried again."""
        off = "the thrusters that work would carry it farther than what is stuck, and are off"
        self.reason = f"{self._why}; {off if alone else self._does}"

    def afloat(self, position: Vector) -> bool:
        """Whether the vehicle has come up to where it floats: thrusters half out of the water do no good there."""
        deep = float(self._place[2] - position[2])
        self._afloat = self._mode.floats and deep < (SUNK_M if self._afloat else AFLOAT_M)
        return self._afloat

    def off_m(self, position: Vector) -> float:
        """How far a vehicle is from the place [m]."""
        return float(np.linalg.norm(self._place - position))

    def motion(self, position: Vector) -> DesiredMotion:
        """Towards the place, never faster than the mode's speed."""
        velocity = (self._place - position) / self._mode.time
        speed = float(np.linalg.norm(velocity))
        return DesiredMotion(velocity * min(1.0, self._mode.speed / max(speed, 1e-12)), np.zeros(3))


LOSS = np.dtype(
    [
        ("limit", np.float64),
        ("patience", np.float64),
        ("was_near", np.bool_),
        ("since", np.float64),
        ("nearest", np.float64),
        ("distance", np.float64),
    ]
)
"""A `LossOfTargetMonitor`: the limit [m] and the patience [s] of its mode, and what it remembers: whether the vehicle
has been within the limit, for how long it has been beyond it without coming nearer [s], the nearest it has come
[m], and how far it is now [m]."""


class LossOfTargetMonitor:
    """Detects that a vehicle has lost its target: beyond the limit, and no nearer than before, for the patience.

    It counts only after the vehicle has been within the limit once, so a start from far away is no loss. Neither is it
    one to take the path up again from far away, as long as the vehicle comes nearer.
    """

    def __init__(self, mode: SafeMode) -> None:
        self._mode = mode
        self.memory: Record = np.array([(mode.limit, mode.patience, False, 0.0, np.inf, 0.0)], LOSS)

    def look_closely(self, limit_m: float | None) -> None:
        """Give up sooner, where what is known of the thrusters says that the path is being left for good; None not."""
        limit, patience = self._mode.limit, self._mode.patience
        if limit_m is not None and np.isfinite(limit):
            limit, patience = min(limit, limit_m), min(patience, CLOSE_S)
        self.memory["limit"], self.memory["patience"] = limit, patience

    def restart(self) -> None:
        """Begin to count anew, from where the vehicle takes its path up again."""
        self.memory["since"], self.memory["nearest"] = 0.0, np.inf

    def reason(self, view: TargetView, dt: float) -> str:
        """Why the path is given up, "" if it is not; to be asked at every tick."""
        if not loses_target(self.memory, view.error, dt):
            return ""
        limit, patience, *_, distance = self.memory[0]
        return f"{distance:.1f} m from its target on the path, beyond {limit:g} m for {patience:g} s"


@compiled
def loses_target(memory, error, dt):
    """One tick of `LossOfTargetMonitor`: whether the target is lost.

    Args:
        memory: record `LOSS`, moved on.
        error: (3,) from the target to the vehicle [m].
        dt: [s].
    """
    m = memory[0]
    m.distance = sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2])
    if m.distance <= m.limit:
        m.was_near, m.since, m.nearest = True, 0.0, m.distance
    elif m.distance <= m.nearest - NEARER * m.limit:
        m.since, m.nearest = 0.0, m.distance
    elif m.was_near:
        m.since += dt
    return m.since >= m.patience
