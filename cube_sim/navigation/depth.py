"""The pressure gauge, read as depth."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.aid import DEPTH
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
    kind: int = field(default=DEPTH, init=False)
    components: int = field(default=1, init=False)
    site: tuple[float, float, float] = field(default=(0.0, 0.0, 0.0), init=False)

    @property
    def constants(self) -> Vector:
        """Standard deviation of [b]."""
        return np.array([self.bias])


@inlined
def depth_reading(constants, position, value, H_motion, H_constants):
    """As `cube_sim.navigation.expectation.expect`."""
    value[0] = constants[0] - position[2]
    H_motion[0, 2], H_constants[0, 0] = -1.0, 1.0
