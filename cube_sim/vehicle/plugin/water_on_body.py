"""What the water does to one body, a hull or a link that it carries, by the address of its record."""

from __future__ import annotations

import numba

from cube_sim.tuples import plus6
from cube_sim.vehicle.laws.current import accelerating_water
from cube_sim.vehicle.laws.hydrodynamics import squares, turning, water_wrench_of
from cube_sim.vehicle.laws.surface import fading_wrench
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.memory import columns_times, double, matrix


@numba.njit
def water_on_body(whole, wet, at_surface, gradient, varies, R, nu, nu_r, surge, down):
    """Wrench of added mass, damping, buoyancy, surface and current, a 6-tuple [N, N m], body axes at the origin.

    Args:
        whole: address of the record of the whole body.
        wet: of what of it is under water; the same where all of it is.
        at_surface: whether some of it may be above.
        gradient: derivative of the share under water, a 6-tuple.
        varies: whether the current changes by place or time.
        R: R_WB (3,3).
        nu: velocity over ground, a 6-tuple, body axes [m/s, rad/s].
        nu_r: the same through the water.
        surge: acceleration of the water, world axes [m/s^2].
        down: gravity, a triple, world axes [m/s^2].
    """
    added, displaced = wet + 8 * layout.ADDED_MASS, double(wet, layout.DISPLACED_MASS)
    r_CB = (double(wet, layout.CENTRE), double(wet, layout.CENTRE + 1), double(wet, layout.CENTRE + 2))
    F = water_wrench_of(
        columns_times(added, turning(nu_r)),
        columns_times(added, nu_r),
        columns_times(wet + 8 * layout.LINEAR, nu_r),
        columns_times(wet + 8 * layout.QUADRATIC, squares(nu_r)),
        R,
        nu_r,
        (-displaced * down[0], -displaced * down[1], -displaced * down[2]),
        r_CB,
    )
    if at_surface:
        F = plus6(F, fading_wrench(columns_times(whole + 8 * layout.ADDED_MASS, nu_r), gradient, nu, nu_r))
    if varies:
        F = plus6(F, accelerating_water(matrix(added, 6, 6), displaced, r_CB, R, surge))
    return F
