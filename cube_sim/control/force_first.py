"""The attainable wrench nearest to one that is not, the force before the torque.

Beside a thruster that is stuck the others may make up for its force or for its torque, not for both at once. To fight
for the attitude first leaves the force to chance, and carries the hull off by metres. With the force first it is turned
by what is stuck, and stays where it is to be; it comes to an attitude in which there is enough for both, or is turned
round and round.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.pace import ForceBudget
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Vector
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

TORQUE = 0.1
"""How much a torque that is missing counts beside the force it takes on the thrusters' rms arm (a choice)."""
SWEEPS = 1000
"""Over the thrusters, at most."""
FINE = 1e-6
"""Share of the largest force by which a sweep that changes less is the last."""


def with_force_first(budget: ForceBudget, force_ratio: float, wrench: Vector) -> Vector:
    """The attainable wrench (6,) [N, N m] nearest to one in the range of A, what is stuck and all; itself if it is one.

    Args:
        budget: what the thrusters can make, and what is stuck.
        force_ratio: share of their force that the supply leaves the thrusters.
        wrench: (6,) [N, N m].
    """
    if np.all(budget.normals @ wrench - budget.held_shares <= force_ratio * budget.attainable.offsets):
        return wrench
    scale = SPATIAL.scale(lever_arm(budget.matrix, SPATIAL)) * np.array([1.0] * 3 + [TORQUE] * 3)
    matrix = np.ascontiguousarray(scale[:, None] * budget.matrix)
    least, most = force_ratio * budget.limits
    forces = np.zeros(matrix.shape[1])
    nearest_forces(matrix, np.sum(matrix**2, axis=0), least, most, scale * (wrench - budget.held), forces)
    return budget.matrix @ forces + budget.held


@compiled
def nearest_forces(matrix, gram, least, most, residual, forces):
    """The forces (k,) that leave least of a wrench (6,), found one by one, again and again; both are moved on.

    Args:
        matrix: (6,k), scaled.
        gram: (k,) the square of each column.
        least: (k,) [N].
        most: (k,) [N].
        residual: (6,) the wrench, scaled; what is left of it in the end.
        forces: (k,) [N] from where to begin.
    """
    largest = 0.0
    for k in range(len(least)):
        largest = max(largest, most[k], -least[k])
    for _ in range(SWEEPS):
        moved = 0.0
        for k in range(len(least)):
            slope = 0.0
            for i in range(6):
                slope += matrix[i, k] * residual[i]
            change = min(max(forces[k] + slope / gram[k], least[k]), most[k]) - forces[k]
            forces[k] += change
            moved = max(moved, abs(change))
            for i in range(6):
                residual[i] -= matrix[i, k] * change
        if moved < FINE * largest:
            break
