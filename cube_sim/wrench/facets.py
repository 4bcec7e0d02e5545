"""Directions across which the wrenches of any box of forces are bounded: they depend on the vehicle alone.

The set of these wrenches is a zonotope: G. M. Ziegler, Lectures on Polytopes (1995), chapter 7.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from cube_sim.wrench.tolerances import SAME_DIRECTION, SAME_SPAN


def facet_normals(columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """(h, r) unit normals of every facet that ``{columns @ f : low <= f <= high}`` can have, whatever low and high.

    By Farkas' lemma w is outside the set exactly when some y has ``y.w > max y.columns f``. That maximum is linear
    between the planes ``y.a_i = 0``, so it is enough to look along the lines where r - 1 of these planes meet: the
    same lines for every box.

    Args:
        columns: (r, m) of rank r.
    """
    r, m = columns.shape
    length = np.linalg.norm(columns, axis=0)
    unit = columns.T / np.where(length > 0.0, length, 1.0)[:, None]
    sets = list(itertools.combinations(range(m), r - 1))
    chosen = np.array(sets, np.intp).reshape(len(sets), r - 1)
    Q, R = np.linalg.qr(np.swapaxes(unit[chosen], 1, 2), mode="complete")
    rises = np.abs(np.diagonal(R, axis1=1, axis2=2)).min(axis=1, initial=1.0)
    normals = Q[rises >= SAME_SPAN, :, -1]
    return np.ascontiguousarray(normals[_distinct(normals)])


def _distinct(lines: NDArray[np.float64]) -> NDArray[np.intp]:
    """Where unit vectors (h, r) are the first of their direction, up to sign and rounding; a few may be left double."""
    first = np.argmax(np.abs(lines) > SAME_DIRECTION, axis=1)
    upright = lines * np.sign(lines[np.arange(len(lines)), first])[:, None]
    _, found = np.unique(np.round(upright / SAME_DIRECTION), axis=0, return_index=True)
    return np.sort(found)
