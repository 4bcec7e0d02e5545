"""The inertia of a tree whose links carry added mass, and forces on a link, for the compiled callbacks.

A link moves by the degrees of freedom from the hull's six to its own joint: its chain. MuJoCo keeps their motion axes
about the centre of mass of the whole tree. With J (6,n) the link's velocity [v; w] in its own axes per velocity of the
chain, its added mass adds J' M_A J to the mass matrix, and a wrench F of the water J' F to the forces.
"""

from __future__ import annotations

import numba

from cube_sim.tuples import cross_tuples, plus, stacked, to_body
from cube_sim.vehicle.plugin.inertia import spatial_row
from cube_sim.vehicle.plugin.memory import columns_times, double, integer, matrix, put, vector


@numba.njit
def dot6(a, b):
    """a' b of two 6-tuples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]


@numba.njit
def spatial(address, i):
    """Spatial vector i of MuJoCo's, (angular, linear), as two 3-tuples."""
    at = 6 * i
    return (
        (double(address, at), double(address, at + 1), double(address, at + 2)),
        (double(address, at + 3), double(address, at + 4), double(address, at + 5)),
    )


@numba.njit
def seen_from(R, offset, angular, linear):
    """[v; w] in body axes, a 6-tuple, of a spatial vector.

    Args:
        R: R_WB (3,3).
        offset: from the point the vector is about to the body's origin, a 3-tuple, world axes [m].
        angular: w, a 3-tuple, world axes.
        linear: v at that point, a 3-tuple.
    """
    return stacked(to_body(R, plus(linear, cross_tuples(angular, offset))), to_body(R, angular))


@numba.njit
def put_arm_inertia(first, count, M, rowadr, rownnz, bodies, parents, cdof, crb, armature):
    """Write again the rows of the mass matrix of a tree's joints, rigid bodies only.

    MuJoCo has written them already; yet derivatives rerun this stage on a matrix that already holds added mass.

    Args:
        first: degree of freedom of the first row.
        count: how many rows.
        M: address of MuJoCo's sparse mass matrix, whose rows hold the columns of the chain up to the diagonal.
        rowadr: address of the starts of all rows; like all that follow MuJoCo's arrays of all degrees of freedom.
        rownnz: of the lengths of rows.
        bodies: of the body of each.
        parents: of the one before each in its chain, -1 for none.
        cdof: of motion axes.
        crb: of composite inertias, one for each body.
        armature: of armatures.
    """
    for i in range(first, first + count):
        row = spatial_row(vector(crb + 80 * integer(bodies, i), 10), matrix(cdof + 48 * i, 1, 6), 0)
        at, j = integer(rowadr, i) + integer(rownnz, i) - 1, i
        for _ in range(integer(rownnz, i)):
            axis = spatial(cdof, j)
            put(M, at, dot6(stacked(axis[0], axis[1]), row))
            at, j = at - 1, integer(parents, j)
        diagonal = integer(rowadr, i) + integer(rownnz, i) - 1
        put(M, diagonal, double(M, diagonal) + double(armature, i))


@numba.njit
def add_link_inertia(added, R, offset, last, M, rowadr, rownnz, parents, cdof):
    """Add J' M_A J of one link to the mass matrix.

    Args:
        added: address of M_A (6,6), column by column, body axes of the link.
        R: its R_WB (3,3).
        offset: from the tree's centre of mass to its origin, a 3-tuple, world axes [m].
        last: the last degree of freedom of its chain.
        M: as in `put_arm_inertia`, like all that follow.
        rowadr: see there.
        rownnz: see there.
        parents: see there.
        cdof: see there.
    """
    i = last
    while i >= 0:
        axis = spatial(cdof, i)
        momentum = columns_times(added, seen_from(R, offset, axis[0], axis[1]))
        at, j = integer(rowadr, i) + integer(rownnz, i) - 1, i
        for _ in range(integer(rownnz, i)):
            other = spatial(cdof, j)
            put(M, at, double(M, at) + dot6(seen_from(R, offset, other[0], other[1]), momentum))
            at, j = at - 1, integer(parents, j)
        i = integer(parents, i)


@numba.njit
def unforced_acceleration(R, offset, cvel, last, parents, cdof_dot, qvel):
    """J' q', the classical acceleration [v' + w x v; w'] of a link whose joints do not accelerate, a 6-tuple.

    Args:
        R: as in `add_link_inertia`, like the next.
        offset: see there.
        cvel: its velocity, two 3-tuples of `spatial`.
        last: see there, like the next.
        parents: see there.
        cdof_dot: address of the rates of the motion axes.
        qvel: address of velocities.
    """
    angular, linear = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    i = last
    while i >= 0:
        rate, speed = spatial(cdof_dot, i), double(qvel, i)
        angular = plus(angular, (speed * rate[0][0], speed * rate[0][1], speed * rate[0][2]))
        linear = plus(linear, (speed * rate[1][0], speed * rate[1][1], speed * rate[1][2]))
        i = integer(parents, i)
    # Spatial acceleration leaves out that the point moves on: w x v of the origin comes back (Featherstone 2008, 2.11).
    w, v = cvel[0], plus(cvel[1], cross_tuples(cvel[0], offset))
    return seen_from(R, offset, angular, plus(linear, cross_tuples(w, v)))


@numba.njit
def add_link_force(F, R, offset, last, parents, cdof, force):
    """Add J' F of a wrench on one link, a 6-tuple in its body axes at its origin, to generalized forces.

    Args:
        F: the wrench [N, N m].
        R: as in `add_link_inertia`, like all but the last.
        offset: see there.
        last: see there.
        parents: see there.
        cdof: see there.
        force: address of the generalized forces.
    """
    i = last
    while i >= 0:
        axis = spatial(cdof, i)
        put(force, i, double(force, i) + dot6(seen_from(R, offset, axis[0], axis[1]), F))
        i = integer(parents, i)
