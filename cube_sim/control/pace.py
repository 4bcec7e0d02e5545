"""The pace along the path that the thrusters can keep.

The target on the path waits for the vehicle (s' = v_T + k2 s1). So the speed along the path is free. It is the first to
fall where the thrusters cannot make all that is asked: the path is kept, at the speed that is left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.attainable.attainable_set import AttainableSet
from cube_sim.spatial import Matrix, Vector

Flags = NDArray[np.bool_]

RESERVE = 0.05
"""Share of what is attainable that is kept for errors the demand does not know of yet."""
PACES = np.linspace(1.0, -1.0, 33)
"""Shares of the speed along the path that are tried; a negative one goes back along it, with a current too strong."""
LEAST_PACE = 0.25
"""Share of the speed below which the vehicle turns to an attitude in which the thrusters have more (a choice)."""
HALVINGS = 5
"""Steps of bisection between two of them."""


@dataclass(frozen=True)
class ForceBudget:
    """What the thrusters that work can make.

    Attributes:
        attainable: the wrenches of those that respond.
        held: (6,) [N, N m] of those that are stuck, on top of it.
    """

    attainable: AttainableSet
    held: Vector

    def excess(self, wrench: Vector, force_ratio: float) -> Vector:
        """By how much a wrench (6,) [N, N m] exceeds each facet of what is attainable with the reserve (p,) [N]."""
        bound = (1.0 - RESERVE) * force_ratio * self.attainable.offsets
        return self.attainable.normals @ (wrench - self.held) - bound

    def allows(self, wrenches: Matrix, force_ratio: float) -> Flags:
        """Whether each of the wrenches (q,6) [N, N m] is attainable with the reserve.

        Args:
            wrenches: in the range of A.
            force_ratio: share of their force that the supply leaves the thrusters.
        """
        needed = (wrenches - self.held) @ self.attainable.normals.T
        bound = (1.0 - RESERVE) * force_ratio * self.attainable.offsets
        return np.all(needed <= bound + 1e-9 * (1.0 + np.abs(bound)), axis=1)


def largest_pace(allowed: Callable[[Matrix], Flags], demand: Callable[[Vector], Matrix]) -> float:
    """The largest share of the speed along the path whose demand is allowed, to 0.2 % of it; 0 where none is.

    Args:
        allowed: wrenches (q,6) -> (q,) whether each can be made.
        demand: paces (q,) -> the wrenches (q,6) that they ask for.
    """
    if allowed(demand(PACES[:1]))[0]:
        return 1.0
    fits = allowed(demand(PACES))
    first = int(np.argmax(fits))
    if not fits[first]:
        return 0.0
    low, high = float(PACES[first]), float(PACES[first - 1])
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if allowed(demand(np.array([middle])))[0] else (low, middle)
    return low
