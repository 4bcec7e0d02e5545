"""What every rule for the desired attitude is given, and what it answers."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from cube_sim.guidance.law import TargetView
from cube_sim.spatial import Matrix, Vector

DESIRED = np.dtype([("quaternion", np.float64, 4), ("rates", np.float64, 3)])
"""`DesiredAttitude` as compiled laws fill it."""
STILL: Vector = np.zeros(3)
"""At rest [m/s]."""


class DesiredAttitude(NamedTuple):
    """What the attitude loop is to follow.

    Attributes:
        quaternion: q_WD (4,) wxyz.
        rates: its angular velocity (3,) [rad/s], world axes.
    """

    quaternion: Vector
    rates: Vector


class Situation(NamedTuple):
    """What an attitude may depend on.

    Attributes:
        view: the vehicle seen from its target on the path.
        rotation: R_WB (3,3), its attitude now.
        force: force (3,) [N] demanded of the thrusters at the tick before, world axes.
        torque: torque (3,) [N m] demanded of them beside that of a steady motion, body axes.
        current: the current (3,) [m/s] as estimated, world axes.
        effort: Q (6,6) of the thrusters that still work, see `cube_sim.control.effort`.
        force_ratio: share of their force that the supply leaves the thrusters.
        velocity: the wanted velocity over ground (3,) [m/s], world axes.
    """

    view: TargetView
    rotation: Matrix
    force: Vector
    torque: Vector
    current: Vector
    effort: Matrix
    force_ratio: float = 1.0
    velocity: Vector = STILL


class AttitudeMode(Protocol):
    """A rule that gives the desired attitude at each tick."""

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The attitude wanted.

        Args:
            situation: of the vehicle now.
            dt: time to the next call [s].
        """
        ...
