"""The compass: where the nose points."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan2

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.aid import HEADING
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
    kind: int = field(default=HEADING, init=False)
    components: int = field(default=1, init=False)
    site: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), init=False)

    @property
    def constants(self) -> Vector:
        """Standard deviation of [b]."""
        return np.array([self.bias])


@inlined
def heading_reading(constants, R, value, H_motion, H_constants):
    """As `cube_sim.navigation.expectation.expect`; whether the nose is level enough to read.

    n changes by phi x n, its heading by phi_z - n_z (n_x phi_x + n_y phi_y) / (n_x^2 + n_y^2).
    """
    x, y, z = R[0, 0], R[1, 0], R[2, 0]
    level = x * x + y * y
    if level < LEAST_LEVEL_PART**2:
        return False
    value[0] = atan2(y, x) + constants[0]
    H_motion[0, 6], H_motion[0, 7], H_motion[0, 8] = -z * x / level, -z * y / level, 1.0
    H_constants[0, 0] = 1.0
    return True
