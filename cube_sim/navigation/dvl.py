"""The Doppler log: velocity over ground by bottom track."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.navigation.aid import Expected
from cube_sim.navigation.motion import Motion
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Vector, cross, skew


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

    @property
    def constants(self) -> Vector:
        """Standard deviations of [s, b]."""
        return np.array([self.scale, self.bias, self.bias, self.bias])

    def expect(self, motion: Motion, constants: Vector) -> Expected:
        """See `Aid.expect`; R_true = Exp(phi) R gives R_true' v = R' v + R' S(v) phi to first order."""
        arm = np.array(self.lever_arm)
        true = motion.velocity @ motion.rotation + cross(motion.rates, arm)
        gain = 1.0 + float(constants[0])
        to_body = gain * motion.rotation.T
        H_motion = np.zeros((3, 12))
        H_motion[:, 3:6] = to_body
        H_motion[:, 6:9] = to_body @ skew(motion.velocity)
        H_motion[:, 9:12] = gain * skew(arm)
        H_constants = np.eye(3, 4, 1)
        H_constants[:, 0] = true
        return Expected(gain * true + constants[1:], H_motion, H_constants)

    def innovation(self, reading: Vector, expected: Vector) -> Vector:
        """The difference [m/s]."""
        return reading - expected
