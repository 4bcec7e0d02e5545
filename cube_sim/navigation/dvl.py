"""The Doppler log: velocity over ground by bottom track."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cube_sim.native.compiled import inlined
from cube_sim.navigation.aid import DVL
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Vector
from cube_sim.tuples import cross_tuples, plus, to_body, triple


@dataclass(frozen=True)
class Dvl:
    """z = (1 + s) (R' v + w x r) + b + noise, body axes: s a scale error (speed of sound), b a bias.

    Attributes:
        sampling: rate and delay.
        noise: standard deviation of each axis of a reading [m/s].
        bias: standard deviation of each axis of b [m/s].
        scale: standard deviation of s.
        lever_arm: r (3,), the sensor seen from the body origin [m].
    """

    sampling: Sampling
    noise: float
    bias: float
    scale: float
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    name: str = "dvl"
    kind: int = field(default=DVL, init=False)
    components: int = field(default=3, init=False)

    @property
    def constants(self) -> Vector:
        """Standard deviations of [s, b]."""
        return np.array([self.scale, self.bias, self.bias, self.bias])

    @property
    def site(self) -> tuple[float, float, float]:
        """The lever arm [m]."""
        return self.lever_arm


@inlined
def dvl_reading(aid, constants, velocity, R, rates, value, H_motion, H_constants):
    """As `cube_sim.navigation.expectation.expect`; R_true = Exp(phi) R gives R_true' v = R' v + R' S(v) phi."""
    r = triple(aid.site)
    true = plus(to_body(R, velocity), cross_tuples(rates, r))
    gain = 1.0 + constants[0]
    for i in range(3):
        value[i] = gain * true[i] + constants[1 + i]
        across = cross_tuples((R[0, i], R[1, i], R[2, i]), velocity)  # row i of R' S(v)
        for j in range(3):
            H_motion[i, 3 + j] = gain * R[j, i]
            H_motion[i, 6 + j] = gain * across[j]
        H_constants[i, 0], H_constants[i, 1 + i] = true[i], 1.0
    H_motion[0, 10], H_motion[0, 11], H_motion[1, 11] = -gain * r[2], gain * r[1], -gain * r[0]
    H_motion[1, 9], H_motion[2, 9], H_motion[2, 10] = gain * r[2], -gain * r[1], gain * r[0]
