"""A current that changes with time and depth, and what its acceleration does to a hull."""

from __future__ import annotations

from cube_sim.native.compiled import compiled
from cube_sim.tuples import cross_tuples, matrix_times_tuple, to_body


@compiled
def bracket(x, xs):
    """Where x lies among increasing xs (n,): the index before it, the index after it, the fraction between them.

    Beyond the ends both indices are that of the nearest point.
    """
    last = xs.shape[0] - 1
    if x <= xs[0]:
        return 0, 0, 0.0
    if x >= xs[last]:
        return last, last, 0.0
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if xs[middle] <= x:
            low = middle
        else:
            high = middle
    return low, high, (x - xs[low]) / (xs[high] - xs[low])


@compiled
def velocity_at(time, height, times_s, heights, velocities):
    """The table's velocity [m/s] at a time and a height, a 3-tuple in world axes; arguments as in `current_at`."""
    n_z = heights.shape[0]
    i, next_i, a = bracket(time, times_s)
    j, next_j, b = bracket(height, heights)
    i, next_i = i * n_z, next_i * n_z
    return (
        _bilinear(velocities, 0, i, next_i, j, next_j, a, b),
        _bilinear(velocities, 1, i, next_i, j, next_j, a, b),
        _bilinear(velocities, 2, i, next_i, j, next_j, a, b),
    )


@compiled
def _bilinear(values, axis, i, next_i, j, next_j, a, b):
    p, q = values[i + j, axis], values[i + next_j, axis]
    r, s = values[next_i + j, axis], values[next_i + next_j, axis]
    early, late = p + b * (q - p), r + b * (s - r)
    return early + a * (late - early)


@compiled
def current_at(time, height, times_s, heights, velocities, steady, step):
    """Current and its acceleration at a place, from a table that is bilinear in time and height.

    The acceleration of a piecewise linear current jumps at the table's points. An integrator that meets a jump within
    a step is off by a share of that step. So the acceleration is the mean of D v_c / Dt over one time step, from half a
    step before to half a step after, along the path of the water that passes the place. Nothing before time 0 is in
    it, where a simulation starts. The weights of Runge-Kutta's stages and of Euler's steps then add up to the whole
    jump, wherever in a step it lies.

    Args:
        time: [s].
        height: z of the place in the world [m], up.
        times_s: (n_t,) increasing [s].
        heights: (n_z,) increasing [m].
        velocities: (n_t n_z, 3) [m/s], world axes, time by time.
        steady: 3-tuple added everywhere [m/s].
        step: the time step [s].

    Returns:
        v_c and D v_c / Dt = dv_c/dt + (v_c)_z dv_c/dz, 3-tuples in world axes [m/s, m/s^2].
    """
    u = velocity_at(time, height, times_s, heights, velocities)
    v = (u[0] + steady[0], u[1] + steady[1], u[2] + steady[2])
    before, after = 0.5 * step, 0.5 * step
    if 0.0 <= time < before:
        before = time
    behind = velocity_at(time - before, height - before * v[2], times_s, heights, velocities)
    ahead = velocity_at(time + after, height + after * v[2], times_s, heights, velocities)
    span = before + after
    return v, ((ahead[0] - behind[0]) / span, (ahead[1] - behind[1]) / span, (ahead[2] - behind[2]) / span)


@compiled
def accelerating_water(M_A, displaced_mass, r_CB, R_WB, acceleration_W):
    """Wrench of water that accelerates as a whole: (M_A + rho V) times its acceleration [N, N m].

    The water pushes the hull as it would the water displaced, with rho V Dv_c/Dt at the centre of buoyancy. The added
    mass follows the difference of the accelerations (Auton, Hunt and Prud'homme 1988, J. Fluid Mech. 197, eq. 4.1).

    Args:
        M_A: added mass (6,6) [kg, kg m, kg m^2], symmetric.
        displaced_mass: rho V [kg].
        r_CB: centre of buoyancy, 3-tuple, in body axes [m].
        R_WB: attitude (3,3), body to world.
        acceleration_W: Dv_c/Dt, 3-tuple, in world axes [m/s^2].

    Returns:
        The wrench in body axes at the body origin as a 6-tuple.
    """
    a = to_body(R_WB, acceleration_W)
    carried = matrix_times_tuple(M_A, (a[0], a[1], a[2], 0.0, 0.0, 0.0))
    f = (displaced_mass * a[0], displaced_mass * a[1], displaced_mass * a[2])
    moment = cross_tuples(r_CB, f)
    return (
        carried[0] + f[0],
        carried[1] + f[1],
        carried[2] + f[2],
        carried[3] + moment[0],
        carried[4] + moment[1],
        carried[5] + moment[2],
    )
