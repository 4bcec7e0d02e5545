"""The water on the links that a hull carries: the part of MuJoCo's callbacks that puts it where MuJoCo looks for it.

The law is the hull's (`cube_sim.vehicle.laws.hydrodynamics`), at the link's own origin, in its own axes, at its own
velocity through the water. Its added mass multiplies the link's acceleration, J q'' + J' q'. The first part goes into
the mass matrix, as the hull's does; nothing lags.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numba

from cube_sim.tuples import minus6
from cube_sim.vehicle.laws.hydrodynamics import relative_velocity
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.link_inertia import (
    add_link_force,
    add_link_inertia,
    put_arm_inertia,
    seen_from,
    spatial,
    unforced_acceleration,
)
from cube_sim.vehicle.plugin.memory import columns_times, double, field, integer, matrix, room_for_hull
from cube_sim.vehicle.plugin.under_water import under_water
from cube_sim.vehicle.plugin.water_on_body import water_on_body


def build_link_water(
    model: Mapping[str, int], data: Mapping[str, int], water_at: Callable
) -> tuple[Callable, Callable]:
    """Compile it for one memory layout.

    Args:
        model: byte offsets of the fields of mjModel.
        data: byte offsets of the fields of mjData.
        water_at: (model, packed, time, height, steady) -> current and its acceleration.

    Returns:
        Functions of the addresses of an mjModel and an mjData: one writes the inertia of the joints on a hull, one adds
        the water on a link.
    """
    mass, m_rowadr, m_rownnz = data["M"], model["M_rowadr"], model["M_rownnz"]
    dof_bodyid, dof_parentid, dof_armature = model["dof_bodyid"], model["dof_parentid"], model["dof_armature"]
    body_rootid, time_, qvel, qfrc_passive = model["body_rootid"], data["time"], data["qvel"], data["qfrc_passive"]
    xpos, xmat, cdof, crb, cvel = data["xpos"], data["xmat"], data["cdof"], data["crb"], data["cvel"]
    cdof_dot, subtree_com = data["cdof_dot"], data["subtree_com"]

    @numba.njit
    def put_arm(m, d, first, count):
        """Rigid inertia of the joints on a hull."""
        put_arm_inertia(
            first,
            count,
            field(d, mass),
            field(m, m_rowadr),
            field(m, m_rownnz),
            field(m, dof_bodyid),
            field(m, dof_parentid),
            field(d, cdof),
            field(d, crb),
            field(m, dof_armature),
        )

    @numba.njit
    def put_link(m, d, packed, link, steady, down):
        """The water on one link: inertia and forces, by the address of its record."""
        body, last = int(double(link, layout.BODY)), int(double(link, layout.DOF))
        position, centre = field(d, xpos) + 24 * body, field(d, subtree_com) + 24 * integer(field(m, body_rootid), body)
        R, surface = matrix(field(d, xmat) + 72 * body, 3, 3), double(packed, layout.SURFACE)
        offset = (
            double(position, 0) - double(centre, 0),
            double(position, 1) - double(centre, 1),
            double(position, 2) - double(centre, 2),
        )
        wet, gradient = link, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        at_surface = double(position, 2) + double(link, layout.REACH) > surface
        if at_surface:
            wet, _, gradient = under_water(link, room_for_hull(), position, R, surface)
        added, parents = wet + 8 * layout.ADDED_MASS, field(m, dof_parentid)
        rows, lengths = field(m, m_rowadr), field(m, m_rownnz)
        add_link_inertia(added, R, offset, last, field(d, mass), rows, lengths, parents, field(d, cdof))
        velocity = spatial(field(d, cvel), body)
        nu = seen_from(R, offset, velocity[0], velocity[1])
        current, surge = water_at(m, packed, double(d + time_, 0), double(position, 2), steady)
        nu_r = relative_velocity(R, nu, current)
        varies = double(packed, layout.CURRENT) >= 0.0
        F = water_on_body(link, wet, at_surface, gradient, varies, R, nu, nu_r, surge, down)
        bias = unforced_acceleration(R, offset, velocity, last, parents, field(d, cdof_dot), field(d, qvel))
        F = minus6(F, columns_times(added, bias))
        add_link_force(F, R, offset, last, parents, field(d, cdof), field(d, qfrc_passive))

    return put_arm, put_link
