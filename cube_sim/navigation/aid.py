"""What every aiding sensor answers: the reading it gives of a motion, and the Jacobian of that reading."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from cube_sim.navigation.motion import Motion
from cube_sim.navigation.sampling import Sampling
from cube_sim.spatial import Matrix, Vector


class Expected(NamedTuple):
    """What a sensor should read, and the linear part of how.

    Attributes:
        value: h (n,).
        H_motion: dh / d[dp, dv, phi, db] (n, 12): world position and velocity, rotation vector in world axes with
            R_true = Exp(phi) R, gyro bias, by which the true rates are smaller than they seem.
        H_constants: dh / d constants (n, c).
    """

    value: Vector
    H_motion: Matrix
    H_constants: Matrix


class Reading(NamedTuple):
    """One reading of an aiding sensor.

    Attributes:
        aid: index of the sensor.
        tick: at which it was taken.
        value: (n,).
    """

    aid: int
    tick: int
    value: Vector


class Aid(Protocol):
    """A sensor beside the inertial unit. Its error is a few constants, drawn once per run, and white noise."""

    @property
    def name(self) -> str:
        """One word; also names its random stream and its channel."""
        ...

    @property
    def sampling(self) -> Sampling:
        """When it takes readings, and how late they arrive."""
        ...

    @property
    def noise(self) -> float:
        """Standard deviation of each component of a reading, in its unit."""
        ...

    @property
    def constants(self) -> Vector:
        """Standard deviations (c,) of its constant errors."""
        ...

    def expect(self, motion: Motion, constants: Vector) -> Expected | None:
        """The reading without noise; None where the sensor has none to give."""
        ...

    def innovation(self, reading: Vector, expected: Vector) -> Vector:
        """The innovation (n,): the reading less the expected one, in its unit."""
        ...
