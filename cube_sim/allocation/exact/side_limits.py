"""Other limits for a vehicle's allocation, in the numbers that the searches read."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.packing import unpack
from cube_sim.allocation.exact.relaxation import relax
from cube_sim.native.compiled import borrowed, compiled


@compiled
def put_limits(packed: NDArray[np.float64], limits: NDArray[np.float64]) -> None:
    """Allocate from now on within these limits; the previous answer stays, and what counts as rounding.

    Args:
        packed: see `pack`; changed here.
        limits: (m, 4) [F_max-, F_DZ-, F_DZ+, F_max+] [N].
    """
    problem = unpack(borrowed(packed))
    for i in range(limits.shape[0]):
        problem.low[i, 0], problem.high[i, 0] = limits[i, 0], limits[i, 1]
        problem.low[i, 2], problem.high[i, 2] = limits[i, 2], limits[i, 3]
        problem.edge[i, 0], problem.edge[i, 2] = limits[i, 1], limits[i, 2]
    for a in range(problem.targets.shape[0]):
        relax(problem.low, problem.high, problem.targets[a], problem.penalty, problem.weights, problem.relaxed[a])
