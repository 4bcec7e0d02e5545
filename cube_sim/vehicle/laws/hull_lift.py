"""What the flow lifts of a hull, as those who reckon with it know it: products of two velocities, compiled.

F_i = sum_jk P_ijk nu_j nu_k + Q_ijk nu_j |nu_k|. Manoeuvring derivatives are such products as they stand; fins that are
not deflected and strips of cross-flow drag nearly are (`cube_sim.vehicle.lift`).
"""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled


@compiled
def hull_lift(hull, nu_r):
    """The wrench of the products, a 6-tuple [N, N m], body axes.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        nu_r: relative velocity, a 6-tuple, body axes [m/s, rad/s].
    """
    P, Q, nu, F = hull[0].velocity_products, hull[0].absolute_products, np.empty(6), np.zeros(6)
    nu[0], nu[1], nu[2], nu[3], nu[4], nu[5] = nu_r
    for j in range(6):
        if nu[j] == 0.0:
            continue
        for k in range(6):
            signed, absolute = nu[j] * nu[k], nu[j] * abs(nu[k])
            for i in range(6):
                F[i] += P[i, j, k] * signed + Q[i, j, k] * absolute
    return (F[0], F[1], F[2], F[3], F[4], F[5])


@compiled
def subtract_lift_slope(hull, nu, slope):
    """Take the derivative of `hull_lift` by the velocity, (6,6), off a matrix.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        nu: (6,) relative velocity [m/s, rad/s], body axes.
        slope: (6,6), changed.
    """
    P, Q = hull[0].velocity_products, hull[0].absolute_products
    for i in range(6):
        for j in range(6):
            for k in range(6):
                slope[i, j] -= P[i, j, k] * nu[k] + Q[i, j, k] * abs(nu[k])
                slope[i, k] -= nu[j] * (P[i, j, k] + Q[i, j, k] * np.sign(nu[k]))
