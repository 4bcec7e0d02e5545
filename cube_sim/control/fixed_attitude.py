"""One attitude in the world."""

from __future__ import annotations

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.spatial import Vector


class FixedAttitude:
    """One attitude in the world, q_WD (4,) wxyz."""

    def __init__(self, quaternion: Vector) -> None:
        self.quaternion = quaternion
        self._desired = DesiredAttitude(quaternion, np.zeros(3))

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The same at every tick."""
        return self._desired
