"""Vectors as tuples of scalars, which the compiler keeps in registers; matrices stay arrays, which are only read.

For vectors as arrays see `cube_sim.spatial`.
"""

from __future__ import annotations

from cube_sim.native.compiled import compiled


@compiled
def cross_tuples(a, b):
    """a x b of two 3-tuples."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled
def matrix_times_tuple(M, x):
    """M x of a (6,6) array and a 6-tuple, a 6-tuple."""
    return (
        _row_times_tuple(M, 0, x),
        _row_times_tuple(M, 1, x),
        _row_times_tuple(M, 2, x),
        _row_times_tuple(M, 3, x),
        _row_times_tuple(M, 4, x),
        _row_times_tuple(M, 5, x),
    )


@compiled
def _row_times_tuple(M, i, x):
    return M[i, 0] * x[0] + M[i, 1] * x[1] + M[i, 2] * x[2] + M[i, 3] * x[3] + M[i, 4] * x[4] + M[i, 5] * x[5]


@compiled
def to_body(R_WB, a_W):
    """R_WB' a_W, a 3-tuple: a world vector (3-tuple) in body axes."""
    return (
        R_WB[0, 0] * a_W[0] + R_WB[1, 0] * a_W[1] + R_WB[2, 0] * a_W[2],
        R_WB[0, 1] * a_W[0] + R_WB[1, 1] * a_W[1] + R_WB[2, 1] * a_W[2],
        R_WB[0, 2] * a_W[0] + R_WB[1, 2] * a_W[1] + R_WB[2, 2] * a_W[2],
    )
