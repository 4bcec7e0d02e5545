"""A current that changes with time and depth, and what its acceleration does to a hull."""

from __future__ import annotations

from cube_sim.compiled import compiled
from cube_sim.vehicle.hydrodynamics import cross, times, to_body


@compiled
def bracket(x, xs):
    """Where x lies among increasing xs (n,): index of the point before it, fraction to the next, 1/spacing.

    Beyond the ends the nearest point holds, and 1/spacing is 0: nothing changes out there. On a point the slope is that
    of the interval that begins there.
    """
    last = xs.shape[0] - 1
    if last == 0 or x < xs[0]:
        return 0, 0.0, 0.0
    if x >= xs[last]:
        return last - 1, 1.0, 0.0
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if xs[middle] <= x:
            low = middle
        else:
            high = middle
    slope = 1.0 / (xs[high] - xs[low])
    return low, (x - xs[low]) * slope, slope


@compiled
def current_at(time, height, times_s, heights, velocities, steady):
    """Current and its acceleration at a place, bilinear in time and height.

    Args:
        time: [s].
        height: z of the place in the world [m], up.
        times_s: (n_t,) increasing [s].
        heights: (n_z,) increasing [m].
        velocities: (n_t n_z, 3) [m/s], world axes, time by time.
        steady: 3-tuple added everywhere [m/s].

    Returns:
        v_c and D v_c / Dt = dv_c/dt + (v_c)_z dv_c/dz, 3-tuples in world axes [m/s, m/s^2]: the acceleration of the
        water that passes the place.
    """
    n_z = heights.shape[0]
    i, a, per_s = bracket(time, times_s)
    j, b, per_m = bracket(height, heights)
    next_i = min(i + 1, times_s.shape[0] - 1)
    next_j = min(j + 1, n_z - 1)
    v_x, t_x, z_x = _bilinear(velocities, 0, i * n_z, next_i * n_z, j, next_j, a, b)
    v_y, t_y, z_y = _bilinear(velocities, 1, i * n_z, next_i * n_z, j, next_j, a, b)
    v_z, t_z, z_z = _bilinear(velocities, 2, i * n_z, next_i * n_z, j, next_j, a, b)
    v = (v_x + steady[0], v_y + steady[1], v_z + steady[2])
    rise = v[2] * per_m
    return v, (t_x * per_s + rise * z_x, t_y * per_s + rise * z_y, t_z * per_s + rise * z_z)


@compiled
def _bilinear(values, axis, i, next_i, j, next_j, a, b):
    """Value, difference along the first and along the second axis of one cell."""
    p, q = values[i + j, axis], values[i + next_j, axis]
    r, s = values[next_i + j, axis], values[next_i + next_j, axis]
    early, late = p + b * (q - p), r + b * (s - r)
    return early + a * (late - early), late - early, (q - p) + a * ((s - r) - (q - p))


@compiled
def accelerating_water(M_A, displaced_mass, r_CB, R_WB, acceleration_W):
    """Wrench of water that accelerates as a whole: (M_A + rho V) times its acceleration (6-tuple, body axes) [N, N m].

    The water would push its own displaced part along with rho V Dv_c/Dt at the centre of buoyancy, and the added mass
    follows the difference of accelerations (Auton, Hunt and Prud'homme 1988, J. Fluid Mech. 197, eq. 4.1).
    """
    a = to_body(R_WB, acceleration_W)
    carried = times(M_A, (a[0], a[1], a[2], 0.0, 0.0, 0.0))
    f = (displaced_mass * a[0], displaced_mass * a[1], displaced_mass * a[2])
    moment = cross(r_CB, f)
    return (
        carried[0] + f[0],
        carried[1] + f[1],
        carried[2] + f[2],
        carried[3] + moment[0],
        carried[4] + moment[1],
        carried[5] + moment[2],
    )
