"""Vectors as tuples of scalars, which the compiler keeps in registers; matrices stay arrays, which are only read.

For vectors as arrays see `cube_sim.spatial`.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import product_components, quaternion_components, rotation_components

quaternion_from_matrix = compiled(quaternion_components)
"""The unit quaternion, a 4-tuple wxyz with w >= 0, of a rotation (3,3)."""
quaternion_times = compiled(product_components)
"""The quaternion product of two 4-tuples."""
rotation_rows = compiled(rotation_components)
"""The rotation, a tuple of three rows, of a unit quaternion, a 4-tuple wxyz."""


@compiled
def triple(a):
    """The 3-tuple of an array (3,)."""
    return (a[0], a[1], a[2])


@compiled
def sextuple(a):
    """The 6-tuple of an array (6,)."""
    return (a[0], a[1], a[2], a[3], a[4], a[5])


@compiled
def put(into, a):
    """into[i] = a[i] of an array (n,) and n numbers.

    `into[:] = a` would compile sentences about shapes that do not fit, for seconds.
    """
    for i in range(len(into)):
        into[i] = a[i]


@compiled
def put_matrix(into, M):
    """into[i, j] = M[i, j] of two matrices of one shape; see `put`."""
    for i in range(into.shape[0]):
        for j in range(into.shape[1]):
            into[i, j] = M[i, j]


@compiled
def plus(a, b):
    """a + b of two 3-tuples."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@compiled
def minus(a, b):
    """a - b of two 3-tuples."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@compiled
def times(number, a):
    """number * a of a 3-tuple."""
    return (number * a[0], number * a[1], number * a[2])


@compiled
def dot(a, b):
    """a' b of two 3-tuples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def length(a):
    """|a| of a 3-tuple."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@compiled
def plus6(a, b):
    """a + b of two 6-tuples."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@compiled
def minus6(a, b):
    """a - b of two 6-tuples."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3], a[4] - b[4], a[5] - b[5])


@compiled
def stacked(a, b):
    """[a; b], a 6-tuple of two 3-tuples."""
    return (a[0], a[1], a[2], b[0], b[1], b[2])


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
def component(a, axis):
    """Component of a 6-tuple by a number known at run time only; to index would be able to raise, here nothing can."""
    if axis < 3:
        return a[0] if axis < 1 else (a[1] if axis < 2 else a[2])
    return a[3] if axis < 4 else (a[4] if axis < 5 else a[5])


@compiled
def to_body(R_WB, a_W):
    """R_WB' a_W, a 3-tuple: a world vector (3-tuple) in body axes."""
    return (
        R_WB[0, 0] * a_W[0] + R_WB[1, 0] * a_W[1] + R_WB[2, 0] * a_W[2],
        R_WB[0, 1] * a_W[0] + R_WB[1, 1] * a_W[1] + R_WB[2, 1] * a_W[2],
        R_WB[0, 2] * a_W[0] + R_WB[1, 2] * a_W[1] + R_WB[2, 2] * a_W[2],
    )


@compiled
def to_world(R_WB, a_B):
    """R_WB a_B, a 3-tuple: a body vector (3-tuple) in world axes; also any (3,3) or wider matrix times a 3-tuple."""
    return (
        R_WB[0, 0] * a_B[0] + R_WB[0, 1] * a_B[1] + R_WB[0, 2] * a_B[2],
        R_WB[1, 0] * a_B[0] + R_WB[1, 1] * a_B[1] + R_WB[1, 2] * a_B[2],
        R_WB[2, 0] * a_B[0] + R_WB[2, 1] * a_B[1] + R_WB[2, 2] * a_B[2],
    )


@compiled
def turned_to_world(R_WB, a_B):
    """`to_world` of an array (3,), an array: the sums of R_WB @ a_B in one order, whatever BLAS is there."""
    return np.array(to_world(R_WB, triple(a_B)))


@compiled
def angle_of_turn(p, q):
    """Angle [rad] of the rotation between two attitudes, quaternions (4,) wxyz, 0 to pi."""
    back, there = (p[0], -p[1], -p[2], -p[3]), (q[0], q[1], q[2], q[3])
    w, x, y, z = quaternion_times(back, there)
    return 2.0 * atan2(sqrt(x * x + y * y + z * z), abs(w))


@compiled
def solve_positive(S, b):
    """The 3-tuple x with S x = b, for a symmetric positive definite (3,3) S and a 3-tuple b, by S = L D L'.

    Only the lower triangle of S is read.
    """
    d0 = S[0, 0]
    l10, l20 = S[1, 0] / d0, S[2, 0] / d0
    d1 = S[1, 1] - l10 * S[1, 0]
    l21 = (S[2, 1] - l20 * S[1, 0]) / d1
    d2 = S[2, 2] - l20 * S[2, 0] - l21 * l21 * d1
    y0 = b[0]
    y1 = b[1] - l10 * y0
    y2 = b[2] - l20 * y0 - l21 * y1
    x2 = y2 / d2
    x1 = y1 / d1 - l21 * x2
    return (y0 / d0 - l10 * x1 - l20 * x2, x1, x2)


@compiled
def rotated(R, spin, angle):
    """R times the rotation by `angle` [rad] about a unit axis (a 3-tuple) in its own axes, a new (3,3) (Rodrigues).

    Args:
        R: (3,3).
        spin: the axis.
        angle: [rad].
    """
    c, s = cos(angle), sin(angle)
    x, y, z = spin
    v = 1.0 - c
    turn = np.array(
        (
            (c + v * x * x, v * x * y - s * z, v * x * z + s * y),
            (v * x * y + s * z, c + v * y * y, v * y * z - s * x),
            (v * x * z - s * y, v * y * z + s * x, c + v * z * z),
        )
    )
    result = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            result[i, j] = R[i, 0] * turn[0, j] + R[i, 1] * turn[1, j] + R[i, 2] * turn[2, j]
    return result


@compiled
def turn_between(q, p):
    """The short way from one attitude to another (4-tuples): a rotation vector (3-tuple) [rad] in their own axes."""
    w, x, y, z = quaternion_times((q[0], -q[1], -q[2], -q[3]), p)
    sine = length((x, y, z))
    if sine == 0.0:
        return (0.0, 0.0, 0.0)
    turn = 2.0 * atan2(sine, abs(w)) / (sine if w >= 0.0 else -sine)
    return (turn * x, turn * y, turn * z)
