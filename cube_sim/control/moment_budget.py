"""What the thrusters can make while their limits follow inflow and voltage: the facets stay, their offsets move."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector

RESERVE = 0.05
"""Share of what is attainable that is kept for errors the demand does not know of yet."""


class MomentBudget(NamedTuple):
    """Facets of what k thrusters make, and the numbers of a controller that follow their limits.

    Attributes:
        gains: (p,k) of each facet by each force: normals A.
        which: (k,) which of the vehicle's thrusters they are; above all of them, a fin, whose limits stay.
        share: (k,) share of its force that each gives.
        offsets: (p,) of the facets [N]; moved on, like all that follow.
        bounds: (p,) the same less the reserve [N].
        limits: (2,k) least and largest forces [N].
    """

    gains: Matrix
    which: NDArray[np.int64]
    share: Vector
    offsets: Vector
    bounds: Vector
    limits: Matrix


NOTHING_MOVES = MomentBudget(
    np.zeros((0, 0)), np.zeros(0, np.int64), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((2, 0))
)
"""Of a controller that reads none of it."""


@compiled
def limit_budget(budget, limits):
    """Move a budget on.

    Args:
        budget: `MomentBudget`.
        limits: (m,4) of all thrusters, whole ones [N].
    """
    for j in range(len(budget.which)):
        if budget.which[j] >= len(limits):
            continue
        budget.limits[0, j] = budget.share[j] * limits[budget.which[j], 0]
        budget.limits[1, j] = budget.share[j] * limits[budget.which[j], 3]
    for i in range(len(budget.offsets)):
        most = 0.0
        for j in range(len(budget.which)):
            gain = budget.gains[i, j]
            most += gain * budget.limits[1 if gain > 0.0 else 0, j]
        budget.offsets[i] = max(most, 0.0)
        budget.bounds[i] = (1.0 - RESERVE) * budget.offsets[i]
