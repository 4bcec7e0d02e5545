"""What a step of a flight is worth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cube_sim.flight import Observation
from cube_sim.spatial import Vector, angle_between


class Stepped(NamedTuple):
    """A step of an environment.

    Attributes:
        before: the flight before it.
        after: the flight after it.
        action: (n,) between -1 and 1, as given.
        effort: mean square of the thrusters' forces after it, as shares of their largest.
        speed: along the path, as the scenario asks for it [m/s]; 0 for a point to hold.
        dt: its length [s].
    """

    before: Observation
    after: Observation
    action: Vector
    effort: float
    speed: float
    dt: float


Reward = Callable[[Stepped], float]


@dataclass(frozen=True)
class FollowingReward:
    """1 a second for a vehicle that is at its target, looks where it should and gets ahead, less what it spends.

    With e the distance from the target [m] and a the angle to the attitude wanted [rad], a second is worth

        (1 - g + g p) (1 - h + h / (1 + (a / A)^2)) / (1 + (e / E)^2) - c effort

    where p, from -1 to 1, is the share of the speed asked for at which the target gets ahead; it is 1 at a point to
    hold, and within E of the path's end. The fractions fall off slowly, so that something is to be gained far away.

    Attributes:
        near_m: E [m].
        near_rad: A [rad].
        attitude: h, share of it that looking right is worth.
        progress: g, share of it that getting ahead is worth.
        effort: c.
    """

    near_m: float = 0.5
    near_rad: float = 0.5
    attitude: float = 0.3
    progress: float = 0.5
    effort: float = 0.1

    def __call__(self, stepped: Stepped) -> float:
        """The reward of a step."""
        after = stepped.after
        e = float(np.linalg.norm(after.view.error))
        a = angle_between(after.wanted, after.state.quaternion)
        near, facing = 1.0 / (1.0 + (e / self.near_m) ** 2), 1.0 / (1.0 + (a / self.near_rad) ** 2)
        share = 1.0
        if stepped.speed > 0.0 and after.view.remaining > self.near_m:
            way = after.view.arc_length - stepped.before.view.arc_length
            share = float(np.clip(way / (stepped.speed * stepped.dt), -1.0, 1.0))
        worth = (1.0 - self.progress + self.progress * share) * (1.0 - self.attitude + self.attitude * facing) * near
        return stepped.dt * (worth - self.effort * stepped.effort)
