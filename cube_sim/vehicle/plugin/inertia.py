"""The inertia of a hull with its added mass, and its factors, where MuJoCo keeps them; for the compiled callbacks."""

from __future__ import annotations

import numba

from cube_sim.vehicle.plugin.memory import double, integer, put

SMALLEST_PIVOT = 1e-15
"""Below it MuJoCo has something to say of the inertia (mjMINVAL)."""


@numba.njit
def spatial_row(crb, cdof, i):
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
def put_inertia(M_A, R, cdof, crb, armature, rowadr, M):
    """Overwrite one hull's rows of the mass matrix by B'(M_RB + M_A)B, B = blkdiag(R', I).

    The free joint's linear axes are the world's, its angular axes the body's. The rigid part is computed again from the
    composite inertia: derivatives rerun this stage on a matrix that already holds M_A. Arms on the hull are in the
    composite.

    Args:
        M_A: added mass (6,6), body axes.
        R: R_WB (3,3).
        cdof: (6,6) and `crb` (10,) as in `spatial_row`.
        crb: the composite inertia.
        armature: address of the joint's six armatures.
        rowadr: address of the six starts of its rows in `M`.
        M: address of MuJoCo's sparse mass matrix, whose rows hold the columns up to the diagonal.
    """
    for i in range(3):
        # R M11 R' + m I, one row at a time
        t0 = R[i, 0] * M_A[0, 0] + R[i, 1] * M_A[1, 0] + R[i, 2] * M_A[2, 0]
        t1 = R[i, 0] * M_A[0, 1] + R[i, 1] * M_A[1, 1] + R[i, 2] * M_A[2, 1]
        t2 = R[i, 0] * M_A[0, 2] + R[i, 1] * M_A[1, 2] + R[i, 2] * M_A[2, 2]
        start = integer(rowadr, i)
        for j in range(i + 1):
            put(M, start + j, t0 * R[j, 0] + t1 * R[j, 1] + t2 * R[j, 2])
        put(M, start + i, double(M, start + i) + crb[9] + double(armature, i))
    for i in range(3, 6):
        f = spatial_row(crb, cdof, i)
        start = integer(rowadr, i)
        for j in range(3):
            # a unit velocity along world axis j picks component j of the momentum: no product needed
            put(M, start + j, f[3 + j] + M_A[i, 0] * R[j, 0] + M_A[i, 1] * R[j, 1] + M_A[i, 2] * R[j, 2])
        for j in range(3, i + 1):
            rigid = (
                cdof[j, 0] * f[0]
                + cdof[j, 1] * f[1]
                + cdof[j, 2] * f[2]
                + cdof[j, 3] * f[3]
                + cdof[j, 4] * f[4]
                + cdof[j, 5] * f[5]
            )
            put(M, start + j, rigid + M_A[i, j])
        put(M, start + i, double(M, start + i) + double(armature, i))


@numba.njit
def put_factors(M, rowadr, into, inverse):
    """Write L and D of one hull's M = L'DL where `mj_factorM` would; False where it has to, for its warning.

    L is unit lower triangular, below the diagonal of the result, whose diagonal is D. The last row is eliminated first.
    Each element is formed by the products and sums that `mj_factorM` forms it by, in its order.

    Args:
        M: address of MuJoCo's sparse mass matrix, whose rows hold the columns up to the diagonal.
        rowadr: address of the six starts of its rows, in `M` and in the result.
        into: address of the result.
        inverse: address of six 1/D.
    """
    a0, a1, a2 = integer(rowadr, 0), integer(rowadr, 1), integer(rowadr, 2)
    a3, a4, a5 = integer(rowadr, 3), integer(rowadr, 4), integer(rowadr, 5)
    m00 = double(M, a0)
    m10, m11 = double(M, a1), double(M, a1 + 1)
    m20, m21, m22 = double(M, a2), double(M, a2 + 1), double(M, a2 + 2)
    m30, m31, m32, m33 = double(M, a3), double(M, a3 + 1), double(M, a3 + 2), double(M, a3 + 3)
    m40, m41, m42, m43 = double(M, a4), double(M, a4 + 1), double(M, a4 + 2), double(M, a4 + 3)
    m50, m51, m52, m53 = double(M, a5), double(M, a5 + 1), double(M, a5 + 2), double(M, a5 + 3)
    m44, m54, m55 = double(M, a4 + 4), double(M, a5 + 4), double(M, a5 + 5)
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
    put(into, a0, m00)
    put(into, a1, m10 * w1)
    put(into, a1 + 1, m11)
    put(into, a2, m20 * w2)
    put(into, a2 + 1, m21 * w2)
    put(into, a2 + 2, m22)
    put(into, a3, m30 * w3)
    put(into, a3 + 1, m31 * w3)
    put(into, a3 + 2, m32 * w3)
    put(into, a3 + 3, m33)
    put(into, a4, m40 * w4)
    put(into, a4 + 1, m41 * w4)
    put(into, a4 + 2, m42 * w4)
    put(into, a4 + 3, m43 * w4)
    put(into, a4 + 4, m44)
    put(into, a5, m50 * w5)
    put(into, a5 + 1, m51 * w5)
    put(into, a5 + 2, m52 * w5)
    put(into, a5 + 3, m53 * w5)
    put(into, a5 + 4, m54 * w5)
    put(into, a5 + 5, m55)
    put(inverse, 0, w0)
    put(inverse, 1, w1)
    put(inverse, 2, w2)
    put(inverse, 3, w3)
    put(inverse, 4, w4)
    put(inverse, 5, w5)
    most = 1.0 / SMALLEST_PIVOT
    return (
        0.0 < w0 < most
        and 0.0 < w1 < most
        and 0.0 < w2 < most
        and 0.0 < w3 < most
        and 0.0 < w4 < most
        and 0.0 < w5 < most
    )
