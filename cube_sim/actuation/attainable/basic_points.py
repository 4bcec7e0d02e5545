"""All corners of {F_m in a box : C F_m = 0}: the exact, finite answer to every linear question about that set.

A linear function of F_m takes its extremes at corners, where all but rank(C) thrusters sit at an end of their range.
Eight thrusters under three conditions have at most C(8,3) 2^5 = 1792 such points.
"""

from __future__ import annotations

from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.tolerances import RANK_THRESHOLD

_TOLERANCE = 1e-9
_AT_ONCE = 2_000_000
"""Forces worked out at once: what fits a processor's memory caches, more or less."""


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
    solved = np.array(list(combinations(range(m), rank)), dtype=int).reshape(comb(m, rank), rank)
    if rank:
        solved = solved[np.linalg.cond(_columns(C, solved)) <= 1.0 / RANK_THRESHOLD]
    at_top = ((np.arange(2 ** (m - rank))[:, None] >> np.arange(m - rank)) % 2).astype(float)
    share = max(1, _AT_ONCE // max(1, len(at_top) * rank))
    parts = [solved[k : k + share] for k in range(0, len(solved), share)]
    return np.concatenate([np.zeros((0, m)), *(_corners(C, low, high, part, at_top, tolerance) for part in parts)])


def _corners(
    C: Matrix, low: Vector, high: Vector, solved: NDArray[np.int_], at_top: Matrix, tolerance: float
) -> Matrix:
    """Corners whose other thrusters are at their lower (0) or upper (1) ends.

    Args:
        C: (rank,m).
        low: (m,).
        high: (m,).
        solved: (q,rank) which thrusters follow from these; all q choices at once.
        at_top: (p,m-rank).
        tolerance: [N].
    """
    (q, rank), m = solved.shape, len(low)
    free = np.ones((q, m), dtype=bool)
    np.put_along_axis(free, solved, values=False, axis=1)
    fixed = np.nonzero(free)[1].reshape(q, m - rank)
    follow = -np.linalg.solve(_columns(C, solved), _columns(C, fixed))  # (q, rank, m - rank)
    start = (follow @ low[fixed][:, :, None])[:, :, 0]
    slope = follow * (high - low)[fixed][:, None, :]
    F = (at_top @ slope.reshape(q * rank, m - rank).T).reshape(len(at_top), q, rank) + start
    inside = np.all(np.abs(F - 0.5 * (low + high)[solved]) <= 0.5 * (high - low)[solved] + tolerance, axis=2)
    end, choice = np.nonzero(inside)
    found = np.empty((len(end), m))
    np.put_along_axis(found, solved[choice], F[inside], axis=1)
    np.put_along_axis(
        found, fixed[choice], np.where(at_top[end] > 0.0, high[fixed[choice]], low[fixed[choice]]), axis=1
    )
    return found


def _columns(C: Matrix, chosen: NDArray[np.int_]) -> Matrix:
    """(q,rank,k) columns of C (rank,m) for each row of chosen (q,k)."""
    return np.transpose(C[:, chosen], (1, 0, 2))


def _independent(conditions: Matrix) -> Matrix:
    """(rank,m) orthonormal rows with the same kernel."""
    _, sigma, Vt = np.linalg.svd(conditions)
    largest = max(sigma[0], np.finfo(float).tiny) if len(sigma) else 0.0
    return Vt[: np.count_nonzero(sigma > RANK_THRESHOLD * largest)]
