"""How a body moves, as sensors feel it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector


class Motion(NamedTuple):
    """What the readings of the aiding sensors depend on.

    Attributes:
        position: p_WB (3,) [m], world axes.
        velocity: of the body origin over ground (3,) [m/s], world axes.
        rotation: R_WB (3,3).
        rates: w (3,) [rad/s], body axes.
    """

    position: Vector
    velocity: Vector
    rotation: Matrix
    rates: Vector


class Truth(NamedTuple):
    """All that sensors measure.

    Attributes:
        motion: the true motion.
        specific_force: f = R_WB' (a - g) (3,) [m/s^2], body axes, at the body origin: what an accelerometer feels.
    """

    motion: Motion
    specific_force: Vector


@compiled
def felt(R, v, acceleration, gravity):
    """What a state of motion is to sensors at the body origin.

    Args:
        R: R_WB (3,3).
        v: of the body origin over ground (3,) [m/s], body axes.
        acceleration: its derivative (3,) [m/s^2], world axes.
        gravity: (3,) [m/s^2], world axes.

    Returns:
        The velocity (3,), world axes, and the specific force (3,), body axes.
    """
    velocity, force = np.zeros(3), np.zeros(3)
    for i in range(3):
        for j in range(3):
            velocity[i] += R[i, j] * v[j]
            force[i] += (acceleration[j] - gravity[j]) * R[j, i]
    return velocity, force
