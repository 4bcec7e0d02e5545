"""The path before the attitude: which part of a wrench the path needs, and which may yield."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix


def force_with_torque(mass: Matrix) -> Matrix:
    """M12 M22^-1 (3,3) [1/m]: the force that comes with a torque which is not to move the body origin.

    A wrench is a primary task of three rows and a secondary one in its null space (Nakamura 1987). The path needs the
    linear acceleration v', three rows of nu' = M^-1 tau + ...; J = [I 0] M^-1. The wrenches with J tau = 0 are
    [M12 M22^-1; I] t for any torque t: mass couples the rows, so a torque that is not to move the origin brings a force
    along. The secondary part is that of the demanded torque, and what is left is a pure force.

    Args:
        mass: M (6,6), rigid body and added mass.
    """
    return np.ascontiguousarray(np.linalg.solve(mass[3:, 3:].T, mass[:3, 3:].T).T, dtype=np.float64)


@compiled
def yield_attitude(coupling, wrench, secondary):
    """Write the part (6,) of a wrench (6,) that gives way to the path: its torque, and the force that comes with it.

    Args:
        coupling: of `force_with_torque`.
        wrench: tau (6,) demanded [N, N m], body axes.
        secondary: out.
    """
    for i in range(3):
        secondary[i] = coupling[i, 0] * wrench[3] + coupling[i, 1] * wrench[4] + coupling[i, 2] * wrench[5]
        secondary[3 + i] = wrench[3 + i]
