"""The convex problem of one subset of thruster sides, equations (8), (10) and (11) of the report."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class SubsetQP:
    """Minimise ``sum w (f - t)^2 / 2`` subject to ``equations @ f = demand`` and ``low <= f <= high``.

    Attributes:
        weight: (m,) w.
        target: (m,) t [N].
        equations: (r, m) orthonormal rows spanning the row space of A.
        demand: (r,) [N].
        low: (m,) [N].
        high: (m,) [N].
    """

    weight: NDArray[np.float64]
    target: NDArray[np.float64]
    equations: NDArray[np.float64]
    demand: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


def subset_qp(
    subset: NDArray[np.int8],
    origin: NDArray[np.float64],
    equations: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    target: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> SubsetQP:
    """Build the problem of one subset.

    Args:
        subset: (m,) side per thruster, -1, 0, +1.
        origin: (m,) any forces making the demanded wrench [N].
        equations: (r, m) see `SubsetQP`.
        low: (m, 3) lower end of each side, negative, off, positive [N].
        high: (m, 3) upper end of each side [N].
        target: (m, 3) preferred force on each side [N].
        weight: (m,) w.
    """
    at = np.arange(len(subset)), subset + 1
    return SubsetQP(weight, target[at], equations, equations @ origin, low[at], high[at])
