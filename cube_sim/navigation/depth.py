"""The pressure gauge, read as depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.navigation.aid import Expected
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Vector


@dataclass(frozen=True)
class Depth:
    """z = -p_z + b + noise: depth of the body origin below z = 0, positive downwards.

    Attributes:
        sampling: rate and delay.
        noise: standard deviation of a reading [m].
        bias: standard deviation of b [m] (air pressure, salinity).
    """

    sampling: Sampling
    noise: float
    bias: float
    name: str = "depth"

    @property
    def constants(self) -> Vector:
        """Standard deviation of [b]."""
        return np.array([self.bias])

    def expect(self, motion: Motion, constants: Vector) -> Expected:
        """See `Aid.expect`."""
        H_motion = np.zeros((1, 12))
        H_motion[0, 2] = -1.0
        return Expected(constants - motion.position[2], H_motion, np.ones((1, 1)))

    def innovation(self, reading: Vector, expected: Vector) -> Vector:
        """The difference [m]."""
        return reading - expected
