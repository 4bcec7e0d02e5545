"""The attainable wrench nearest to one that is not, the force before the torque.

Beside a thruster that is stuck the others may make up for its force or for its torque, not for both at once. To fight
for the attitude first leaves the force to chance, and carries the hull off by metres. With the force first it is turned
by what is stuck, and stays where it is to be; it comes to an attitude in which there is enough for both, or is turned
round and round.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.control.nearest_forces import THOROUGH, nearest_forces
from cube_sim.control.pace import ForceBudget, facet_excess
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.tuples import sextuple
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

TORQUE = 0.1
"""How much a torque that is missing counts beside the force it takes on the thrusters' rms arm (a choice)."""
LITTLE_TORQUE = 0.003
"""The same where no attitude is to be come to in which there is enough for both and a little over, and every force is
there in any: no force is given for a torque then, which has what the force leaves (a choice)."""


class ForceFirst(NamedTuple):
    """What serving the force first reads beside the normals and held shares of `ForceBudget`.

    Attributes:
        offsets: (p,) [N] of the facets, without a reserve.
        matrix: A (6,k) of the thrusters that respond.
        limits: (2,k) their least and largest forces [N].
        held: (6,) [N, N m] of those that are stuck.
        weight: (6,6) [1, 1/m] what is missing, as it counts: the force that moves the hull, then the torque.
        off_range: whether a wrench may be out of the range of A, of which no facet tells.
    """

    offsets: Vector
    matrix: Matrix
    limits: Matrix
    held: Vector
    weight: Matrix
    off_range: bool

    @classmethod
    def of(cls, budget: ForceBudget, coupling: Matrix, off_range: bool = False, torque: float = TORQUE) -> ForceFirst:
        """What it reads of a budget.

        Args:
            budget: what the thrusters can make, and what is stuck.
            coupling: (3,3) [1/m], of `cube_sim.control.priority.force_with_torque`.
            off_range: whether wrenches may be out of the range of A.
            torque: what a missing one counts.
        """
        weight = np.diag(SPATIAL.scale(lever_arm(budget.matrix, SPATIAL)) * np.array([1.0] * 3 + [torque] * 3))
        weight[:3, 3:] = -coupling
        arrays = budget.attainable.offsets, budget.matrix, budget.limits, budget.held, weight
        offsets, matrix, limits, held, weight = (np.ascontiguousarray(array, dtype=np.float64) for array in arrays)
        return cls(offsets, matrix, limits, held, weight, off_range)


NOT_FORCE_FIRST = ForceFirst(np.zeros(0), np.zeros((6, 0)), np.zeros((2, 0)), np.zeros(6), np.zeros((6, 6)), False)
"""Where the torque is served as well as the force."""


@compiled
def serve_force_first(parts, normals, held_shares, force_ratio, wrench):
    """Make of a wrench in the range of A the attainable one nearest to it, what is stuck and all; itself if it is one.

    Args:
        parts: `ForceFirst`.
        normals: of `ForceBudget`, like the next.
        held_shares: of it.
        force_ratio: share of their force that the supply leaves the thrusters.
        wrench: (6,) [N, N m], moved on.
    """
    demanded, beyond = sextuple(wrench), parts.off_range
    for i in range(len(parts.offsets)):  # one that is no number is beyond no facet, and stays none
        if facet_excess(normals, parts.offsets, held_shares, force_ratio, i, demanded) > 0.0:
            beyond = True
    if not beyond:
        return
    A, count = parts.matrix, parts.matrix.shape[1]
    scaled, residual = np.zeros((6, count)), np.zeros(6)
    gram, forces, least, most = np.zeros(count), np.zeros(count), np.empty(count), np.empty(count)
    for i in range(6):
        for j in range(6):
            residual[i] += parts.weight[i, j] * (wrench[j] - parts.held[j])
            for k in range(count):
                scaled[i, k] += parts.weight[i, j] * A[j, k]
        for k in range(count):
            gram[k] += scaled[i, k] ** 2
    for k in range(count):
        least[k], most[k] = force_ratio * parts.limits[0, k], force_ratio * parts.limits[1, k]
    nearest_forces(scaled, gram, least, most, THOROUGH, residual, forces)
    for i in range(6):
        made = 0.0
        for k in range(count):
            made += A[i, k] * forces[k]
        wrench[i] = made + parts.held[i]
