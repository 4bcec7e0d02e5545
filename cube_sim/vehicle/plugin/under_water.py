"""The record of what of a body is under water, for the compiled callbacks."""

from __future__ import annotations

import numba

from cube_sim.vehicle.laws.surface import hull_under_water
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.memory import double, put


@numba.njit
def under_water(hull, room, position, R, surface):
    """Address of the record of what of a hull is under water, its share, and the derivative of that, a 6-tuple.

    Args:
        hull: address of the record of the whole hull.
        room: address of room for another record.
        position: address of p_WB.
        R: R_WB (3,3).
        surface: height of the water's surface, world axes [m].
    """
    up = (R[2, 0], R[2, 1], R[2, 2])
    r_CB = (double(hull, layout.CENTRE), double(hull, layout.CENTRE + 1), double(hull, layout.CENTRE + 2))
    half_axes = (
        double(hull, layout.HALF_AXES),
        double(hull, layout.HALF_AXES + 1),
        double(hull, layout.HALF_AXES + 2),
    )
    depth = surface - double(position, 2) - (up[0] * r_CB[0] + up[1] * r_CB[1] + up[2] * r_CB[2])
    share, centre, gradient = hull_under_water(depth, up, half_axes, r_CB)
    put(room, layout.DISPLACED_MASS, share * double(hull, layout.DISPLACED_MASS))
    put(room, layout.CENTRE, centre[0])
    put(room, layout.CENTRE + 1, centre[1])
    put(room, layout.CENTRE + 2, centre[2])
    for i in range(layout.ADDED_MASS, layout.FORCE):
        put(room, i, share * double(hull, i))
    return room, share, gradient
