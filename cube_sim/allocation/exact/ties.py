"""Which of two equally good subsets is the answer, so that the same question always has the same answer."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled


@compiled
def slack_of(best: float) -> float:
    """Difference in cost that counts as rounding next to the best cost [N^2]."""
    return 1e-9 * (abs(best) + 1e-6) if best < math.inf else 0.0


@compiled
def changed(sides: NDArray[np.float64], previous: NDArray[np.float64]) -> int:
    """Number of motors whose side differs from the previous one."""
    count = 0
    for i in range(sides.shape[0]):
        count += sides[i] != previous[i]
    return count


@compiled
def preferred(
    cost: float,
    best: float,
    sides: NDArray[np.float64],
    subset: NDArray[np.float64],
    changes: int,
    changes_best: int,
) -> bool:
    """Whether an answer replaces the best so far: cheaper, or as cheap and with fewer motors changing side.

    What is equal in that too goes to the subset whose first differing motor pushes forward.

    Args:
        cost: of the new answer [N^2].
        best: least cost so far [N^2].
        sides: (m,) subset of the new answer.
        subset: (m,) subset of the best so far.
        changes: motors of the new answer that change side.
        changes_best: motors of the best so far that do.
    """
    slack = slack_of(best)
    if cost < best - slack:
        return True
    if cost > best + slack:
        return False
    if changes != changes_best:
        return changes < changes_best
    for i in range(sides.shape[0]):
        if sides[i] != subset[i]:
            return bool(sides[i] > subset[i])
    return False
