"""How a body moves, as sensors feel it."""

from __future__ import annotations

from typing import NamedTuple

from cube_sim.spatial import Matrix, Vector


class Motion(NamedTuple):
    """What the readings of the aiding sensors depend on; true or estimated.

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
