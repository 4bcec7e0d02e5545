"""Rates that take a few numbers towards zero, damped: nothing is singular where no rate can change them."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.tuples import solve_positive


@compiled
def damped_inverse(J, y, rows, damping):
    """(J' J + d I)^-1 J' y, a 3-tuple, of the first rows of J and y; the same as J' (J J' + d I)^-1 y.

    Written with the (3,3) matrix, which is never larger than that of the rows.

    Args:
        J: (at least rows, 3).
        y: (at least rows,).
        rows: how many count.
        damping: d, in the units of J squared.
    """
    square = np.zeros((3, 3))
    g0 = g1 = g2 = 0.0
    for k in range(rows):
        a, b, c = J[k, 0], J[k, 1], J[k, 2]
        g0 += a * y[k]
        g1 += b * y[k]
        g2 += c * y[k]
        square[0, 0] += a * a
        square[1, 0] += b * a
        square[1, 1] += b * b
        square[2, 0] += c * a
        square[2, 1] += c * b
        square[2, 2] += c * c
    for i in range(3):
        square[i, i] += damping
    return solve_positive(square, (g0, g1, g2))
