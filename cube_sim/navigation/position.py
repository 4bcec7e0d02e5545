"""The acoustic position fix, from a baseline on the bottom or under a ship."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.navigation.aid import Expected
from cube_sim.navigation.motion import Motion
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

    @property
    def constants(self) -> Vector:
        """None."""
        return np.zeros(0)

    def expect(self, motion: Motion, constants: Vector) -> Expected:
        """See `Aid.expect`."""
        return Expected(motion.position, np.eye(3, 12), np.zeros((3, 0)))

    def innovation(self, reading: Vector, expected: Vector) -> Vector:
        """The difference [m]."""
        return reading - expected
