"""All corners of {F_m allowed : C F_m = 0}: the exact, finite answer to every linear question about that set.

On each choice of one interval per thruster the set is a polytope, and a linear function of F_m takes its extremes at
corners, where all but rank(C) thrusters sit on an end of an interval. Eight thrusters under five conditions have at
most C(8,5) 5^3 = 7000 such points, so that no linear program is needed and dead zones cost no search.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from math import comb, prod

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.allowed import AllowedForces
from cube_sim.actuation.wrench_axes import Matrix

MOST_POINTS = 100_000
"""Above this many candidates the question is left unanswered (`candidates`): it would take seconds."""
_INDEPENDENT = 1e-9
_TOLERANCE = 1e-9


@dataclass(frozen=True)
class BasicPoints:
    """Corners of a set of thruster forces.

    Attributes:
        forces: (p,m) F_m [N].
        cells: (p,m) index of the allowed interval that holds each force: points of one cell span one polytope.
    """

    forces: Matrix
    cells: NDArray[np.int_]


def candidates(conditions: Matrix, allowed: AllowedForces) -> int:
    """An upper bound on the points `basic_points` has to look at."""
    m = conditions.shape[1]
    free = m - len(_independent(conditions))
    ends = max((len(allowed.breakpoints(i)) for i in range(m)), default=0)
    return comb(m, free) * ends**free


def basic_points(conditions: Matrix, allowed: AllowedForces) -> BasicPoints:
    """Enumerate the corners.

    Args:
        conditions: C (c,m), any rank.
        allowed: the intervals of the m thrusters.

    Returns:
        The corners, each possibly several times; none when no allowed F_m satisfies the conditions.
    """
    C = _independent(conditions)
    rank, m = C.shape
    tolerance = _TOLERANCE * max(1.0, float(np.max(np.abs([allowed.minimum, allowed.maximum]))))
    ends = [allowed.breakpoints(i) for i in range(m)]
    found, cells = [np.zeros((0, m))], [np.zeros((0, m), dtype=int)]
    for fixed in combinations(range(m), m - rank):
        solved = [i for i in range(m) if i not in fixed]
        if rank and np.linalg.cond(C[:, solved]) > 1.0 / _INDEPENDENT:
            continue
        F = np.empty((prod(len(ends[i]) for i in fixed), m))
        F[:, list(fixed)] = _grid([ends[i] for i in fixed])
        F[:, solved] = -np.linalg.solve(C[:, solved], C[:, list(fixed)] @ F[:, list(fixed)].T).T
        held = allowed.interval(F, tolerance)
        inside = np.all(held >= 0, axis=1)
        found.append(F[inside])
        cells.append(held[inside])
    return BasicPoints(np.concatenate(found), np.concatenate(cells))


def _independent(conditions: Matrix) -> Matrix:
    """(rank,m) orthonormal rows with the same kernel."""
    _, sigma, Vt = np.linalg.svd(conditions)
    return Vt[: np.count_nonzero(sigma > _INDEPENDENT * max(sigma[0], np.finfo(float).tiny))] if len(sigma) else Vt[:0]


def _grid(ends: list[NDArray[np.float64]]) -> Matrix:
    """Every choice of one end per thruster, (product of the counts, len(ends))."""
    if not ends:
        return np.zeros((1, 0))
    return np.stack([axis.ravel() for axis in np.meshgrid(*ends, indexing="ij")], axis=1)
