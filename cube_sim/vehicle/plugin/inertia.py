"""The inertia of a hull with its added mass, and its factors, as MuJoCo keeps them; for the compiled callbacks.

A lower triangle is a 21-tuple, row by row.
"""

from __future__ import annotations

import numba

from cube_sim.vehicle.plugin.memory import double, integer, put

SMALLEST_PIVOT = 1e-15
"""Below it MuJoCo has something to say of the inertia (mjMINVAL)."""


@numba.njit
def _spatial_row(crb, cdof, i):
    """Composite inertia times motion axis i, a 6-tuple: MuJoCo's 10-vector inertia (I, m c, m) on an axis (w, v).

    Args:
        crb: (10,) I_xx, I_yy, I_zz, I_xy, I_xz, I_yz [kg m^2], m c [kg m], m [kg].
        cdof: (6,6) motion axes (w, v) of the free joint.
        i: which of them.
    """
    w0, w1, w2 = cdof[i, 0], cdof[i, 1], cdof[i, 2]
    v0, v1, v2 = cdof[i, 3], cdof[i, 4], cdof[i, 5]
    return (
        crb[0] * w0 + crb[3] * w1 + crb[4] * w2 - crb[8] * v1 + crb[7] * v2,
        crb[3] * w0 + crb[1] * w1 + crb[5] * w2 + crb[8] * v0 - crb[6] * v2,
        crb[4] * w0 + crb[5] * w1 + crb[2] * w2 - crb[7] * v0 + crb[6] * v1,
        crb[8] * w1 - crb[7] * w2 + crb[9] * v0,
        crb[6] * w2 - crb[8] * w0 + crb[9] * v1,
        crb[7] * w0 - crb[6] * w1 + crb[9] * v2,
    )


@numba.njit
def _motion_times(cdof, j, f):
    """Motion axis j (w, v) times a spatial momentum, a 6-tuple."""
    return (
        cdof[j, 0] * f[0]
        + cdof[j, 1] * f[1]
        + cdof[j, 2] * f[2]
        + cdof[j, 3] * f[3]
        + cdof[j, 4] * f[4]
        + cdof[j, 5] * f[5]
    )


@numba.njit
def _added_linear(M_A, R, i, j):
    """Element i, j of R M11 R', M11 the upper left (3,3) of added mass."""
    t0 = R[i, 0] * M_A[0, 0] + R[i, 1] * M_A[1, 0] + R[i, 2] * M_A[2, 0]
    t1 = R[i, 0] * M_A[0, 1] + R[i, 1] * M_A[1, 1] + R[i, 2] * M_A[2, 1]
    t2 = R[i, 0] * M_A[0, 2] + R[i, 1] * M_A[1, 2] + R[i, 2] * M_A[2, 2]
    return t0 * R[j, 0] + t1 * R[j, 1] + t2 * R[j, 2]


@numba.njit
def _coupling(M_A, R, i, j, f):
    """Element i, j of M, i an angular axis and j a linear one; f the spatial momentum of axis i.

    A unit velocity along world axis j picks component j of the momentum: no product needed.
    """
    return f[3 + j] + M_A[i, 0] * R[j, 0] + M_A[i, 1] * R[j, 1] + M_A[i, 2] * R[j, 2]


@numba.njit
def hull_inertia(M_A, R, cdof, crb, armature):
    """One hull's block of the mass matrix, B'(M_RB + M_A)B with B = blkdiag(R', I): its lower triangle.

    The free joint's linear axes are the world's, its angular axes the body's. The rigid part is computed again from the
    composite inertia: derivatives rerun this stage on a matrix that already holds M_A. Arms on the hull are in the
    composite.

    Args:
        M_A: added mass (6,6), body axes.
        R: R_WB (3,3).
        cdof: (6,6) motion axes (w, v) of the free joint.
        crb: (10,) the composite inertia, I_xx, I_yy, I_zz, I_xy, I_xz, I_yz [kg m^2], m c [kg m], m [kg].
        armature: address of the joint's six armatures.
    """
    f3, f4, f5 = _spatial_row(crb, cdof, 3), _spatial_row(crb, cdof, 4), _spatial_row(crb, cdof, 5)
    return (
        _added_linear(M_A, R, 0, 0) + crb[9] + double(armature, 0),
        _added_linear(M_A, R, 1, 0),
        _added_linear(M_A, R, 1, 1) + crb[9] + double(armature, 1),
        _added_linear(M_A, R, 2, 0),
        _added_linear(M_A, R, 2, 1),
        _added_linear(M_A, R, 2, 2) + crb[9] + double(armature, 2),
        _coupling(M_A, R, 3, 0, f3),
        _coupling(M_A, R, 3, 1, f3),
        _coupling(M_A, R, 3, 2, f3),
        _motion_times(cdof, 3, f3) + M_A[3, 3] + double(armature, 3),
        _coupling(M_A, R, 4, 0, f4),
        _coupling(M_A, R, 4, 1, f4),
        _coupling(M_A, R, 4, 2, f4),
        _motion_times(cdof, 3, f4) + M_A[4, 3],
        _motion_times(cdof, 4, f4) + M_A[4, 4] + double(armature, 4),
        _coupling(M_A, R, 5, 0, f5),
        _coupling(M_A, R, 5, 1, f5),
        _coupling(M_A, R, 5, 2, f5),
        _motion_times(cdof, 3, f5) + M_A[5, 3],
        _motion_times(cdof, 4, f5) + M_A[5, 4],
        _motion_times(cdof, 5, f5) + M_A[5, 5] + double(armature, 5),
    )


@numba.njit
def put_rows(triangle, rowadr, into):
    """Write a lower triangle into one of MuJoCo's sparse matrices, whose rows hold the columns up to the diagonal.

    Args:
        triangle: 21-tuple.
        rowadr: address of the six starts of its rows.
        into: address of the matrix.
    """
    k = 0
    for i in range(6):
        start = integer(rowadr, i)
        for j in range(i + 1):
            put(into, start + j, triangle[k])
            k += 1


@numba.njit
def factors(triangle):
    """L and D of M = L'DL with unit lower triangular L, the last row eliminated first, as MuJoCo does.

    Each element is formed by the products and sums that `mj_factorM` forms it by, in its order.

    Args:
        triangle: M.

    Returns:
        L below the diagonal and D on it; and 1/D, a 6-tuple.
    """
    m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, m40, m41, m42, m43, m44, m50, m51, m52, m53, m54, m55 = triangle
    w5 = 1.0 / m55
    s = -m54 * w5
    m40, m41, m42, m43, m44 = m40 + m50 * s, m41 + m51 * s, m42 + m52 * s, m43 + m53 * s, m44 + m54 * s
    w4 = 1.0 / m44
    s = -m53 * w5
    m30, m31, m32, m33 = m30 + m50 * s, m31 + m51 * s, m32 + m52 * s, m33 + m53 * s
    s = -m43 * w4
    m30, m31, m32, m33 = m30 + m40 * s, m31 + m41 * s, m32 + m42 * s, m33 + m43 * s
    w3 = 1.0 / m33
    s = -m52 * w5
    m20, m21, m22 = m20 + m50 * s, m21 + m51 * s, m22 + m52 * s
    s = -m42 * w4
    m20, m21, m22 = m20 + m40 * s, m21 + m41 * s, m22 + m42 * s
    s = -m32 * w3
    m20, m21, m22 = m20 + m30 * s, m21 + m31 * s, m22 + m32 * s
    w2 = 1.0 / m22
    s = -m51 * w5
    m10, m11 = m10 + m50 * s, m11 + m51 * s
    s = -m41 * w4
    m10, m11 = m10 + m40 * s, m11 + m41 * s
    s = -m31 * w3
    m10, m11 = m10 + m30 * s, m11 + m31 * s
    s = -m21 * w2
    m10, m11 = m10 + m20 * s, m11 + m21 * s
    w1 = 1.0 / m11
    m00 = m00 + m50 * (-m50 * w5)
    m00 = m00 + m40 * (-m40 * w4)
    m00 = m00 + m30 * (-m30 * w3)
    m00 = m00 + m20 * (-m20 * w2)
    m00 = m00 + m10 * (-m10 * w1)
    w0 = 1.0 / m00
    factored = (
        m00,
        m10 * w1, m11,
        m20 * w2, m21 * w2, m22,
        m30 * w3, m31 * w3, m32 * w3, m33,
        m40 * w4, m41 * w4, m42 * w4, m43 * w4, m44,
        m50 * w5, m51 * w5, m52 * w5, m53 * w5, m54 * w5, m55,
    )  # fmt: skip
    return factored, (w0, w1, w2, w3, w4, w5)


@numba.njit
def put_factors(triangle, rowadr, into, inverse):
    """Write the factors of a hull's inertia where `mj_factorM` would; False where it has to, for its warning.

    Args:
        triangle: of the inertia.
        rowadr: of `put_rows`, like the next.
        into: of it.
        inverse: address of six 1/D.
    """
    factored, inverses = factors(triangle)
    put_rows(factored, rowadr, into)
    whole = True
    for i in range(6):
        put(inverse, i, inverses[i])
        whole = whole and 0.0 < inverses[i] < 1.0 / SMALLEST_PIVOT
    return whole
