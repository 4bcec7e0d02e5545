"""All corners of {F_m in a box : C F_m = 0}: the exact, finite answer to every linear question about that set.

A linear function of F_m takes its extremes at corners, where all but rank(C) thrusters sit at an end of their range.
Eight thrusters under three conditions have at most C(8,3) 2^5 = 1792 such points.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from cube_sim.actuation.wrench_axes import Matrix, Vector

_INDEPENDENT = 1e-9
_TOLERANCE = 1e-9


def basic_points(conditions: Matrix, low: Vector, high: Vector) -> Matrix:
    """Enumerate the corners.

    Args:
        conditions: C (c,m), any rank.
        low: (m,) ends of the box [N].
        high: (m,) [N].

    Returns:
        (p,m) the corners, each possibly several times; none when no F_m in the box satisfies the conditions.
    """
    C = _independent(conditions)
    rank, m = C.shape
    tolerance = _TOLERANCE * max(1.0, float(np.max(np.abs([low, high]))))
    at_top = (np.arange(2 ** (m - rank))[:, None] >> np.arange(m - rank)) % 2 == 1
    found = [np.zeros((0, m))]
    for choice in combinations(range(m), m - rank):
        fixed, solved = list(choice), [i for i in range(m) if i not in choice]
        if rank and np.linalg.cond(C[:, solved]) > 1.0 / _INDEPENDENT:
            continue
        F = np.empty((len(at_top), m))
        F[:, fixed] = np.where(at_top, high[fixed], low[fixed])
        F[:, solved] = -F[:, fixed] @ np.linalg.solve(C[:, solved], C[:, fixed]).T
        inside = np.all((F[:, solved] >= low[solved] - tolerance) & (F[:, solved] <= high[solved] + tolerance), axis=1)
        found.append(F[inside])
    return np.concatenate(found)


def _independent(conditions: Matrix) -> Matrix:
    """(rank,m) orthonormal rows with the same kernel."""
    _, sigma, Vt = np.linalg.svd(conditions)
    return Vt[: np.count_nonzero(sigma > _INDEPENDENT * max(sigma[0], np.finfo(float).tiny))] if len(sigma) else Vt[:0]
