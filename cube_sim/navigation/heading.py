"""The compass: where the nose points."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, pi

import numpy as np

from cube_sim.navigation.aid import Expected
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Vector

LEAST_LEVEL_PART = 0.25
"""Level part of the nose's direction below which it has no heading worth reading: 75.5 degrees up or down."""


@dataclass(frozen=True)
class Heading:
    """z = atan2(n_y, n_x) + b + noise with n = R e_x, the nose in world axes: from x (east) towards y (north).

    Attributes:
        sampling: rate and delay.
        noise: standard deviation of a reading [rad].
        bias: standard deviation of b [rad] (deviation, declination, mounting).
    """

    sampling: Sampling
    noise: float
    bias: float
    name: str = "heading"

    @property
    def constants(self) -> Vector:
        """Standard deviation of [b]."""
        return np.array([self.bias])

    def expect(self, motion: Motion, constants: Vector) -> Expected | None:
        """See `Aid.expect`.

        n changes by phi x n, its heading by phi_z - n_z (n_x phi_x + n_y phi_y) / (n_x^2 + n_y^2).
        """
        x, y, z = motion.rotation[:, 0].tolist()
        level = x * x + y * y
        if level < LEAST_LEVEL_PART**2:
            return None
        H_motion = np.zeros((1, 12))
        H_motion[0, 6:9] = -z * x / level, -z * y / level, 1.0
        return Expected(atan2(y, x) + constants, H_motion, np.ones((1, 1)))

    def innovation(self, reading: Vector, expected: Vector) -> Vector:
        """The difference, the short way round [rad]."""
        return (reading - expected + pi) % (2.0 * pi) - pi
