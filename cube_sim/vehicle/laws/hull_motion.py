"""The equations of motion of one hull on a record of its numbers, compiled.

A record is a structured array of one element: it costs a compiled call no more than one plain array does.
"""

from __future__ import annotations

from math import pi

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.tuples import (
    cross_tuples,
    matrix_times_tuple,
    minus6,
    plus6,
    sextuple,
    stacked,
    to_body,
    to_world,
    triple,
)
from cube_sim.vehicle.laws.hull_lift import hull_lift, subtract_lift_slope
from cube_sim.vehicle.laws.hydrodynamics import coriolis, damping, relative_velocity, water_wrench

HULL = np.dtype(
    [
        ("mass_matrix", np.float64, (6, 6)),
        ("added_mass", np.float64, (6, 6)),
        ("total_mass", np.float64, (6, 6)),
        ("linear_damping", np.float64, (6, 6)),
        ("quadratic_damping", np.float64, (6, 6)),
        ("hydrostatics", np.float64, (6, 3)),
        ("centre_of_mass", np.float64, 3),
        ("centre_of_buoyancy", np.float64, 3),
        ("gravity", np.float64, 3),
        ("displaced_mass", np.float64),
        ("velocity_products", np.float64, (6, 6, 6)),
        ("absolute_products", np.float64, (6, 6, 6)),
        ("lifts", np.bool_),
    ]
)
"""Numbers of a hull: see `cube_sim.vehicle.dynamics.Dynamics`, whose names these are."""


@compiled
def inverse_dynamics(hull, R_WB, nu, nu_dot, v_c_W):
    """tau = M_RB nu' + C_RB nu + M_A a - (everything else the water does) - weight, a 6-tuple [N, N m], body axes.

    a = [v' + w x v; w'] as in `cube_sim.vehicle.laws.hydrodynamics.water_wrench`.

    Args:
        hull: record `HULL`.
        R_WB: (3,3).
        nu: [v; w] over ground, a 6-tuple, body axes [m/s, rad/s].
        nu_dot: its derivative in body axes, a 6-tuple.
        v_c_W: steady current, a 3-tuple, world axes [m/s].
    """
    h = hull[0]
    turning = cross_tuples(nu[3:], nu[:3])
    classical = (
        nu_dot[0] + turning[0],
        nu_dot[1] + turning[1],
        nu_dot[2] + turning[2],
        nu_dot[3],
        nu_dot[4],
        nu_dot[5],
    )
    rigid, c = matrix_times_tuple(h.mass_matrix, nu_dot), coriolis(h.mass_matrix, nu)
    added = matrix_times_tuple(h.added_mass, classical)
    gravity = triple(h.gravity)
    lift = (-h.displaced_mass * gravity[0], -h.displaced_mass * gravity[1], -h.displaced_mass * gravity[2])
    water = water_wrench(
        h.added_mass, h.linear_damping, h.quadratic_damping, R_WB, nu, v_c_W, lift, triple(h.centre_of_buoyancy)
    )
    if h.lifts:
        water = plus6(water, hull_lift(hull, relative_velocity(R_WB, nu, v_c_W)))
    m = h.mass_matrix[0, 0]
    weight = to_body(R_WB, (m * gravity[0], m * gravity[1], m * gravity[2]))
    moment = cross_tuples(triple(h.centre_of_mass), weight)
    return (
        rigid[0] + c[0] + added[0] - water[0] - weight[0],
        rigid[1] + c[1] + added[1] - water[1] - weight[1],
        rigid[2] + c[2] + added[2] - water[2] - weight[2],
        rigid[3] + c[3] + added[3] - water[3] - moment[0],
        rigid[4] + c[4] + added[4] - water[4] - moment[1],
        rigid[5] + c[5] + added[5] - water[5] - moment[2],
    )


@compiled
def inverse_dynamics_of_arrays(hull, R_WB, nu, nu_dot, v_c_W):
    """`inverse_dynamics` of arrays nu (6,), nu_dot (6,) and v_c_W (3,), an array (6,)."""
    return np.array(inverse_dynamics(hull, R_WB, sextuple(nu), sextuple(nu_dot), triple(v_c_W)))


@compiled
def hull_damping(hull, nu_r):
    """D nu_r + D_q |nu_r| nu_r, a 6-tuple [N, N m], of a 6-tuple [m/s, rad/s] relative to the water, body axes."""
    h = hull[0]
    return damping(h.linear_damping, h.quadratic_damping, nu_r)


@compiled
def steady_wrench(hull, v, up):
    """The wrench, a 6-tuple [N, N m], that keeps a motion without rotation steady in still water.

    Drag, Munk moment, what the flow lifts, weight and buoyancy.

    Args:
        hull: record `HULL`.
        v: 3-tuple [m/s], body axes.
        up: world up in body axes, a 3-tuple.
    """
    h = hull[0]
    drag = damping(h.linear_damping, h.quadratic_damping, (v[0], v[1], v[2], 0.0, 0.0, 0.0))
    munk = cross_tuples(v, to_world(h.total_mass, v))
    if h.lifts:
        drag = minus6(drag, hull_lift(hull, (v[0], v[1], v[2], 0.0, 0.0, 0.0)))
    lifted = to_world(h.hydrostatics, up), to_world(h.hydrostatics[3:], up)
    return minus6(plus6(drag, stacked((0.0, 0.0, 0.0), munk)), stacked(lifted[0], lifted[1]))


@compiled
def steady_wrenches(hull, velocities, ups):
    """`steady_wrench` of arrays (q,3) and (q,3), an array (q,6)."""
    wrenches = np.empty((len(velocities), 6))
    for i in range(len(velocities)):
        wrench = steady_wrench(hull, triple(velocities[i]), triple(ups[i]))
        for j in range(6):
            wrenches[i, j] = wrench[j]
    return wrenches


@compiled
def steady_wrench_slope(hull, nu, swing):
    """(6,6) derivative by nu of C(nu) nu + D nu + D_q |nu| nu, less what the flow lifts.

    With the momenta [p; h] = M nu, C(nu) nu = [w x p; v x p + w x h] (Fossen 2011, theorem 3.2). Its derivative is
    [[S(w), 0], [S(v), S(w)]] M - [[0, S(p)], [S(p), S(h)]].

    Args:
        hull: record `HULL`.
        nu: (6,) [m/s, rad/s], body axes.
        swing: (6,) amplitude of oscillations about nu [m/s, rad/s], see `Dynamics.steady_wrench_slope`.
    """
    hu = hull[0]
    M = hu.total_mass
    momentum = matrix_times_tuple(M, sextuple(nu))
    p, h = momentum[:3], momentum[3:]
    v, w = (nu[0], nu[1], nu[2]), (nu[3], nu[4], nu[5])
    slope = np.empty((6, 6))
    for j in range(6):
        above, below = (M[0, j], M[1, j], M[2, j]), (M[3, j], M[4, j], M[5, j])
        force, munk, gyro = cross_tuples(w, above), cross_tuples(v, above), cross_tuples(w, below)
        quadratic = max(2.0 * abs(nu[j]), 8.0 / (3.0 * pi) * swing[j])
        for i in range(3):
            slope[i, j] = force[i] + hu.linear_damping[i, j] + hu.quadratic_damping[i, j] * quadratic
            slope[3 + i, j] = (
                munk[i] + gyro[i] + hu.linear_damping[3 + i, j] + hu.quadratic_damping[3 + i, j] * quadratic
            )
    subtract_skew(slope, 0, 3, p)
    subtract_skew(slope, 3, 0, p)
    subtract_skew(slope, 3, 3, h)
    if hu.lifts:
        subtract_lift_slope(hull, nu, slope)
    return slope


@compiled
def subtract_skew(M, row, column, a):
    """Take S(a), S(a) b = a x b of a 3-tuple, off the (3,3) block of M that begins at a row and a column."""
    M[row, column + 1] += a[2]
    M[row, column + 2] -= a[1]
    M[row + 1, column] -= a[2]
    M[row + 1, column + 2] += a[0]
    M[row + 2, column] += a[1]
    M[row + 2, column + 1] -= a[0]


@compiled
def restoring_slope(hull, up):
    """(6,3) [N/rad, N m/rad] derivative of weight and lift by a small rotation theta in body axes, up' = up x theta.

    Args:
        hull: record `HULL`.
        up: world up in body axes, a 3-tuple.
    """
    H = hull[0].hydrostatics
    slope = np.empty((6, 3))
    for i in range(6):
        # H S(up): row i of it is row i of H, crossed with up
        row = cross_tuples((H[i, 0], H[i, 1], H[i, 2]), up)
        slope[i, 0], slope[i, 1], slope[i, 2] = row
    return slope


@compiled
def turning_slope(hull, by_velocity, v, force, up):
    """(6,3) [N/rad, N m/rad] derivative of a steady wrench by a small rotation theta in body axes.

    Of `steady_wrench` and a force beside it. What stands still in the world turns as a' = a x theta in body axes.

    Args:
        hull: record `HULL`.
        by_velocity: (6,6) of `steady_wrench_slope`.
        v: relative to the water, a 3-tuple [m/s], body axes.
        force: a 3-tuple [N], body axes.
        up: world up in body axes, a 3-tuple.
    """
    slope = restoring_slope(hull, up)
    for i in range(6):
        row = cross_tuples((by_velocity[i, 0], by_velocity[i, 1], by_velocity[i, 2]), v)
        for j in range(3):
            slope[i, j] = row[j] - slope[i, j]
    x, y, z = force
    slope[0, 1] -= z
    slope[0, 2] += y
    slope[1, 0] += z
    slope[1, 2] -= x
    slope[2, 0] -= y
    slope[2, 1] += x
    return slope
