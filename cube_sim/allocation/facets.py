"""Directions across which the wrenches of any box of forces are bounded: they depend on the vehicle alone."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray


def facet_normals(columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """(h, r) unit normals of every facet that ``{columns @ f : low <= f <= high}`` can have, whatever low and high.

    By Farkas' lemma w is outside the set exactly when some y has ``y.w > max y.columns f``. That maximum is linear
    between the planes ``y.a_i = 0``, so it is enough to look along the lines where r - 1 of these planes meet: the
    same lines for every box.

    Args:
        columns: (r, m) of rank r.
    """
    r, m = columns.shape
    rows: list[NDArray[np.float64]] = []
    for chosen in itertools.combinations(range(m), r - 1):
        _, sigma, Vt = np.linalg.svd(np.vstack([columns[:, list(chosen)].T, np.zeros((1, r))]))
        if r > 1 and sigma[r - 2] < 1e-10:
            continue
        if not any(abs(abs(Vt[-1] @ known) - 1.0) < 1e-14 for known in rows):
            rows.append(Vt[-1])
    return np.array(rows).reshape(-1, r)
