"""A scenario's `telemetry` block at work: forces as the motors report them."""

from __future__ import annotations

import numpy as np

from cube_sim.navigation.streams import stream
from cube_sim.scenario.telemetry_block import TelemetryBlock
from cube_sim.spatial import Matrix, Vector


class Telemetry:
    """What is read of the forces of m thrusters: gain times force, and white noise.

    Args:
        block: the scenario's `telemetry`.
        m: number of thrusters.
        seed: root of the random stream.

    Attributes:
        gain: (m,) of the readings.
    """

    def __init__(self, block: TelemetryBlock, m: int, seed: int) -> None:
        self.gain = np.full(m, block.gain) if block.thruster_gains is None else np.array(block.thruster_gains)
        self._noise = block.noise_N
        self.reseed(seed)

    def reseed(self, seed: int) -> None:
        """Start the noise anew."""
        self._random = stream(seed, "telemetry")

    def read(self, force: Vector) -> Vector:
        """(m,) readings [N] of the forces (m,) [N]; once per control period."""
        if self._noise == 0.0:
            return self.gain * force
        return self.gain * force + self._noise * self._random.standard_normal(len(force))

    def noise_ahead(self, count: int) -> Matrix:
        """The noise (count, m) [N] of the next readings, of which none is taken; (0, m) where there is no noise."""
        if self._noise == 0.0:
            return np.zeros((0, len(self.gain)))
        before = self._random.bit_generator.state
        noise = self._noise * self._random.standard_normal((count, len(self.gain)))
        self._random.bit_generator.state = before
        return noise

    def skip(self, count: int) -> None:
        """Take so many readings, whose noise was read ahead."""
        if self._noise != 0.0:
            self._random.standard_normal((count, len(self.gain)))
