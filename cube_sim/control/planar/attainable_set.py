"""The forces ahead and torques a hull can make together, and how a demand outside of them is saturated."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.moment_budget import MomentBudget
from cube_sim.native.compiled import compiled

Array = NDArray[np.float64]


class PlanarAttainableSet(NamedTuple):
    """The (F, Gamma) a hull's thrusters can make together.

    The other four components of the wrench are left free, and dead zones are ignored. The set is a zonogon; each of its
    edges is square to one of `normals`.

    Attributes:
        normals: (k, 2) [1, 1/m].
        sizes: normals . (F, Gamma) is at most this (k,) [N].
    """

    normals: Array
    sizes: Array

    @classmethod
    def of(cls, A: Array, limits: Array) -> PlanarAttainableSet:
        """The set of thrusters with the columns A (6, m) and forces between `limits` (m, 2) [N]."""
        columns = A[[0, 5]]
        columns = columns[:, np.linalg.norm(columns, axis=0) > 1e-12]
        across = np.column_stack([-columns[1], columns[0]]) / np.linalg.norm(columns, axis=0)[:, None]
        normals = np.vstack([across, -across])
        each = normals @ A[[0, 5]]
        return cls(normals, np.maximum(each * limits[:, 0], each * limits[:, 1]).sum(axis=1))

    def moving(self, A: Array, limits: Array) -> MomentBudget:
        """What of it follows limits (m, 2) that move; of one that no other controller reads. Arguments as for `of`."""
        gains = np.ascontiguousarray(self.normals @ A[[0, 5]])
        m = A.shape[1]
        return MomentBudget(gains, np.arange(m), np.ones(m), self.sizes, self.sizes.copy(), limits.T.copy())

    def holds(self, F: float, Gamma: float) -> bool:
        """Whether a demand [N, N m] is attainable."""
        return holds(self.normals, self.sizes, F, Gamma)

    def saturate(self, F: float, Gamma: float, torque_share: float = 0.5) -> tuple[float, float]:
        """An attainable demand [N, N m], see `saturate`."""
        return saturate(self.normals, self.sizes, F, Gamma, torque_share)


@compiled
def holds(normals, sizes, F, Gamma):
    """Whether a demand is attainable.

    Args:
        normals: of `PlanarAttainableSet`, like the next.
        sizes: of it.
        F: force ahead [N].
        Gamma: torque [N m].
    """
    inside = True
    for i in range(len(sizes)):
        inside = inside and normals[i, 0] * F + normals[i, 1] * Gamma <= sizes[i] * (1.0 + 1e-9) + 1e-9
    return inside


@compiled
def range_left(normals, sizes, axis, other):
    """Lowest and highest value of the force (axis 0) or the torque (1), given the other one."""
    low, high = -inf, inf
    for i in range(len(sizes)):
        along = normals[i, axis]
        left = sizes[i] - normals[i, 1 - axis] * other
        if along > 1e-12:
            high = min(high, left / along)
        elif along < -1e-12:
            low = max(low, left / along)
    return low, high


@compiled
def saturate(normals, sizes, F, Gamma, torque_share):
    """An attainable demand [N, N m]: itself where it is one, otherwise neither part at the cost of the other.

    The closest attainable wrench is no use to the planar law. At low speed the law asks for a hundred times the
    torque of the hull. All thrust would then go into torque, and none would be left to gather the speed at which
    the law asks for less. So there are three steps:

    1. The torque takes `torque_share` of what it could have alone.
    2. The force takes what it wants of the rest.
    3. The torque takes what it wants of what that leaves.

    Args:
        normals: of `PlanarAttainableSet`, like the next.
        sizes: of it.
        F: force ahead asked for [N].
        Gamma: torque asked for [N m].
        torque_share: in [0, 1].
    """
    if holds(normals, sizes, F, Gamma):
        return F, Gamma
    low, high = range_left(normals, sizes, 1, 0.0)
    first = min(max(Gamma, torque_share * low), torque_share * high)
    low, high = range_left(normals, sizes, 0, first)
    force = min(max(F, low), high)
    low, high = range_left(normals, sizes, 1, force)
    return force, min(max(Gamma, low), high)
