"""What the thrusters that are left make of a wrench, as a scenario that does not say allocates it, and how soon.

Of the wrench asked for the part that yields is given its largest attainable share. Of what is out of reach the nearest
one is made, torques counting more than forces; of several answers the one of least force. Dead zones are not in it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.allocation.box_least_squares import nearest_in_box
from cube_sim.control.pace import ForceBudget
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

TORQUE_WEIGHT = 30.0
"""Of torque against force errors where a demand is out of reach, as a scenario that does not say allocates."""
PRICE = 1e-6
"""Of forces beside what is missing of the wrench: next to nothing."""


class LeftThrusters(NamedTuple):
    """Those that respond, and what others hold.

    Attributes:
        matrix: A (6,k) of those that respond.
        scale: (6,) [1, 1/m] by which errors of a wrench are compared.
        low: (k,) [N].
        high: (k,) [N].
        lag_s: (k,) of each [s].
        held: (6,) wrench of those that do not respond [N, N m].
        normals: (p,6) of the facets of what is attainable.
        offsets: (p,) [N] of them.
    """

    matrix: Matrix
    scale: Vector
    low: Vector
    high: Vector
    lag_s: Vector
    held: Vector
    normals: Matrix
    offsets: Vector

    @classmethod
    def of(
        cls, budget: ForceBudget, lag_s: Vector, force_ratio: float = 1.0, torque_weight: float = TORQUE_WEIGHT
    ) -> LeftThrusters:
        """Those of a budget.

        Args:
            budget: what they can make.
            lag_s: (k,) of each.
            force_ratio: share of their force that the supply leaves them.
            torque_weight: of torque against force errors where a demand is out of reach.
        """
        scale = SPATIAL.scale(lever_arm(budget.matrix, SPATIAL)) * np.array([1.0] * 3 + [torque_weight] * 3)
        low, high = force_ratio * budget.limits
        offsets = force_ratio * budget.attainable.offsets
        arrays = budget.matrix, scale, low, high, lag_s, budget.held, budget.normals, offsets
        return cls(*(np.ascontiguousarray(array, dtype=np.float64) for array in arrays))

    def with_fault(self, thruster: int, given_N: float) -> LeftThrusters:
        """What moves the hull where one of them, by its number here, gives a force whatever it is asked for."""
        matrix, held = self.matrix.copy(), self.held + given_N * self.matrix[:, thruster]
        matrix[:, thruster] = 0.0
        return self._replace(matrix=matrix, held=held)


@compiled
def make_wrench(thrusters, wrench, secondary, asked, applied):
    """The forces asked of them for a wrench.

    Args:
        thrusters: `LeftThrusters`.
        wrench: (6,) demanded, what is held and all [N, N m].
        secondary: (6,) the part of it that yields.
        asked: (k,) [N] the forces of the tick before; those of this one.
        applied: (6,) out, the wrench they make.
    """
    share = 1.0
    for i in range(len(thrusters.offsets)):
        excess, yielding = -thrusters.offsets[i], 0.0
        for j in range(6):
            excess += thrusters.normals[i, j] * (wrench[j] - secondary[j] - thrusters.held[j])
            yielding += thrusters.normals[i, j] * secondary[j]
        if yielding > 0.0 and excess + yielding > 0.0:
            share = min(share, max(0.0, -excess / yielding))
    target, scaled = np.empty(6), np.empty(thrusters.matrix.shape)
    for j in range(6):
        target[j] = thrusters.scale[j] * (wrench[j] - (1.0 - share) * secondary[j] - thrusters.held[j])
        for i in range(len(asked)):
            scaled[j, i] = thrusters.scale[j] * thrusters.matrix[j, i]
    nearest_in_box(scaled, target, np.full(len(asked), PRICE), thrusters.low, thrusters.high, asked)
    for j in range(6):
        applied[j] = thrusters.held[j]
        for i in range(len(asked)):
            applied[j] += thrusters.matrix[j, i] * asked[i]


@compiled
def spin_up(thrusters, asked, forces, seconds, wrench):
    """Forces (k,) [N] some time later, behind their lag, and the wrench (6,) with what is held, out."""
    for i in range(len(forces)):
        lag = thrusters.lag_s[i]
        forces[i] += (1.0 if lag <= 0.0 else 1.0 - np.exp(-seconds / lag)) * (asked[i] - forces[i])
    for j in range(6):
        wrench[j] = thrusters.held[j]
        for i in range(len(forces)):
            wrench[j] += thrusters.matrix[j, i] * forces[i]
