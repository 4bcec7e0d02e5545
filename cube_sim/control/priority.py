"""The path before the attitude: which part of a wrench the path needs, and which may yield."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.spatial import Matrix, Vector


class Split(NamedTuple):
    """A wrench in two parts, body axes [N, N m].

    Attributes:
        primary: (6,) what gives the body origin its linear acceleration and no torque at all.
        secondary: (6,) the rest; any share of it changes the angular acceleration alone.
    """

    primary: Vector
    secondary: Vector


def split_path_first(wrench: Vector, mass: Matrix) -> Split:
    """Split a wrench into a primary task of three rows and a secondary one in its null space (Nakamura 1987).

    The path needs the linear acceleration v', three rows of nu' = M^-1 tau + ...; J = [I 0] M^-1. The wrenches with
    J tau = 0 are [M12 M22^-1; I] t for any torque t: mass couples the rows, so a torque that is not to move the origin
    brings a force along. The secondary part is that of the demanded torque, and what is left is a pure force.

    Args:
        wrench: tau (6,) demanded [N, N m], body axes.
        mass: M (6,6), rigid body and added mass.
    """
    torque = wrench[3:]
    secondary = np.concatenate([mass[:3, 3:] @ np.linalg.solve(mass[3:, 3:], torque), torque])
    return Split(wrench - secondary, secondary)
