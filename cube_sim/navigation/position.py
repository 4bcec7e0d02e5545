"""The acoustic position fix, from a baseline on the bottom or under a ship."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.aid import POSITION
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Vector


@dataclass(frozen=True)
class PositionFix:
    """z = p + noise, world axes.

    Attributes:
        sampling: rate and delay.
        noise: standard deviation of each axis of a reading [m].
    """

    sampling: Sampling
    noise: float
    name: str = "position"
    kind: int = field(default=POSITION, init=False)
    components: int = field(default=3, init=False)
    site: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), init=False)

    @property
    def constants(self) -> Vector:
        """None."""
        return np.zeros(0)


@inlined
def position_reading(position, value, H_motion):
    """As `cube_sim.navigation.expectation.expect`."""
    for i in range(3):
        value[i], H_motion[i, i] = position[i], 1.0
