"""How a body moves: all that sensors measure."""

from __future__ import annotations

from typing import NamedTuple

from cube_sim.spatial import Matrix, Vector


class Motion(NamedTuple):
    """What the readings of all sensors depend on.

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
