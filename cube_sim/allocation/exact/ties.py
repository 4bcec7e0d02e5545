"""Which of two equally good subsets is the answer: the same question always has the same answer."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled


@compiled
def tie_tolerance(best: float) -> float:
    """Difference in cost that counts as rounding next to the best cost [N^2]."""
    return 1e-9 * (abs(best) + 1e-6) if best < math.inf else 0.0


@compiled
def count_changes(subset: NDArray[np.float64], previous: NDArray[np.float64]) -> int:
    """Number of thrusters whose side differs from the previous one."""
    count = 0
    for i in range(subset.shape[0]):
        count += subset[i] != previous[i]
    return count


@compiled
def preferred(
    cost: float,
    best: float,
    subset: NDArray[np.float64],
    best_subset: NDArray[np.float64],
    changes: int,
    changes_best: int,
) -> bool:
    """Whether an answer replaces the best so far.

    ==================  ==========================  ===========================================  ========
    cost                thrusters that change side  first thruster that differs from the best    replaces
    ==================  ==========================  ===========================================  ========
    less                any                         any                                          yes
    more                any                         any                                          no
    the same            fewer                       any                                          yes
    the same            more                        any                                          no
    the same            as many                     pushes more forward                          yes
    the same            as many                     pushes more backward, or there is none       no
    ==================  ==========================  ===========================================  ========

    "The same" is within `tie_tolerance`.

    Args:
        cost: of the new answer [N^2].
        best: least cost so far [N^2].
        subset: (m,) sides of the new answer.
        best_subset: (m,) sides of the best so far.
        changes: thrusters of the new answer that change side.
        changes_best: thrusters of the best so far that do.
    """
    slack = tie_tolerance(best)
    if cost < best - slack:
        return True
    if cost > best + slack:
        return False
    if changes != changes_best:
        return changes < changes_best
    for i in range(subset.shape[0]):
        if subset[i] != best_subset[i]:
            return bool(subset[i] > best_subset[i])
    return False
