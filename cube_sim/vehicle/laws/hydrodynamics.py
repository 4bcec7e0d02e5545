"""The force of the water on a rigid hull, written once.

Every function here is plain Python on arrays and tuples. Run as it stands it is the readable reference; compiled by
numba (`cube_sim.vehicle.plugin.hook`) it is MuJoCo's callback.

Source: T. I. Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control (2011), chapters 6 to 8, in body axes
with z up:  (M_RB + M_A) nu_r' + C_RB(nu) nu + C_A(nu_r) nu_r + D nu_r + D_q |nu_r| nu_r + g(eta) = tau,
nu_r = nu - [v_c; 0] for a uniform irrotational current v_c, whose body-axes components turn as v_c' = -w x v_c.
"""

from __future__ import annotations

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, matrix_times_tuple, to_body


@compiled
def coriolis(M, nu):
    """C(nu) nu [N, N m], a 6-tuple, for any symmetric (6,6) mass matrix M.

    With the momenta p = M11 v + M12 w and h = M21 v + M22 w it is [w x p; v x p + w x h] (Fossen 2011, theorem 3.2).
    For added mass and relative velocity, v x p is the Munk moment.

    Args:
        M: (6,6) [kg, kg m, kg m^2], symmetric.
        nu: velocity [v; w], a 6-tuple, body axes [m/s, rad/s].
    """
    return coriolis_of(matrix_times_tuple(M, nu), nu)


@compiled
def coriolis_of(momentum, nu):
    """`coriolis` by [p; h] = M nu, a 6-tuple [kg m/s, kg m^2/s]."""
    p, h, v, w = momentum[:3], momentum[3:], nu[:3], nu[3:]
    force, munk, gyro = cross_tuples(w, p), cross_tuples(v, p), cross_tuples(w, h)
    return (force[0], force[1], force[2], munk[0] + gyro[0], munk[1] + gyro[1], munk[2] + gyro[2])


@compiled
def squares(nu_r):
    """|nu_r| nu_r of a 6-tuple, each by itself."""
    return (
        abs(nu_r[0]) * nu_r[0],
        abs(nu_r[1]) * nu_r[1],
        abs(nu_r[2]) * nu_r[2],
        abs(nu_r[3]) * nu_r[3],
        abs(nu_r[4]) * nu_r[4],
        abs(nu_r[5]) * nu_r[5],
    )


@compiled
def damping(D, D_q, nu_r):
    """D nu_r + D_q |nu_r| nu_r [N, N m], a 6-tuple: linear and quadratic drag; arguments as in `water_wrench`."""
    a, b = matrix_times_tuple(D, nu_r), matrix_times_tuple(D_q, squares(nu_r))
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@compiled
def relative_velocity(R_WB, nu, v_c_W):
    """nu_r = nu - [R_WB' v_c; 0] [m/s, rad/s], a 6-tuple in body axes; arguments as in `water_wrench`."""
    v_c = to_body(R_WB, v_c_W)
    return (nu[0] - v_c[0], nu[1] - v_c[1], nu[2] - v_c[2], nu[3], nu[4], nu[5])


@compiled
def water_wrench(M_A, D, D_q, R_WB, nu, v_c_W, buoyancy_W, r_CB):
    """Everything the water does to a hull except the term that multiplies its acceleration.

    MuJoCo integrates the classical acceleration, a = [v' + w x v; w'] in body axes. The water's wrench is -M_A a plus
    what is returned. The current turns in body axes, so M_A nu_r' = M_A a - M_A [w x v_r; 0]: the last term is part of
    what is returned.

    Args:
        M_A: added mass (6,6) [kg, kg m, kg m^2], symmetric.
        D: linear damping (6,6) [N s/m, N s, N m s].
        D_q: quadratic damping (6,6) [N s^2/m^2, ...].
        R_WB: attitude (3,3), body to world.
        nu: velocity [v; w], a 6-tuple, of the body origin in body axes [m/s, rad/s].
        v_c_W: current, 3-tuple, in world axes [m/s].
        buoyancy_W: -rho V g, 3-tuple, in world axes [N].
        r_CB: centre of buoyancy, 3-tuple, in body axes [m].

    Returns:
        The wrench in body axes at the body origin as a 6-tuple [N, N m].
    """
    nu_r = relative_velocity(R_WB, nu, v_c_W)
    carried, momentum = matrix_times_tuple(M_A, turning(nu_r)), matrix_times_tuple(M_A, nu_r)
    linear, quadratic = matrix_times_tuple(D, nu_r), matrix_times_tuple(D_q, squares(nu_r))
    return water_wrench_of(carried, momentum, linear, quadratic, R_WB, nu_r, buoyancy_W, r_CB)


@compiled
def turning(nu_r):
    """[w x v_r; 0] [m/s^2], a 6-tuple: how the relative velocity (6-tuple) turns in body axes."""
    a = cross_tuples(nu_r[3:], nu_r[:3])
    return (a[0], a[1], a[2], 0.0, 0.0, 0.0)


@compiled
def water_wrench_of(carried, momentum, linear, quadratic, R_WB, nu_r, buoyancy_W, r_CB):
    """`water_wrench` by the products of its matrices.

    Args:
        carried: M_A [w x v_r; 0] [N, N m], a 6-tuple like all but R_WB and the last two.
        momentum: M_A nu_r [kg m/s, kg m^2/s].
        linear: D nu_r [N, N m].
        quadratic: D_q |nu_r| nu_r [N, N m].
        R_WB: as in `water_wrench`, like the last two.
        nu_r: relative velocity, body axes [m/s, rad/s].
        buoyancy_W: see there.
        r_CB: see there.
    """
    c = coriolis_of(momentum, nu_r)
    f = to_body(R_WB, buoyancy_W)
    moment = cross_tuples(r_CB, f)
    return (
        carried[0] - c[0] - (linear[0] + quadratic[0]) + f[0],
        carried[1] - c[1] - (linear[1] + quadratic[1]) + f[1],
        carried[2] - c[2] - (linear[2] + quadratic[2]) + f[2],
        carried[3] - c[3] - (linear[3] + quadratic[3]) + moment[0],
        carried[4] - c[4] - (linear[4] + quadratic[4]) + moment[1],
        carried[5] - c[5] - (linear[5] + quadratic[5]) + moment[2],
    )
