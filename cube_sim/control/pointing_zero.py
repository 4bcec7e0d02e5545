"""How fast a force may be asked for that has to be pointed first.

A hull that turns to point its force is pushed the wrong way at first where the torque for turning comes with a force,
or where it has more added mass along its course than across. From attitude to place the transfer function then has
zeros in the right half plane, and no loop around it can be faster than the slowest of them (J. S. Freudenberg and
D. P. Looze, IEEE TAC 30, 1985).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.authority import Capability
from cube_sim.control.course_trim import CourseTrims
from cube_sim.spatial import Matrix, Vector, skew
from cube_sim.vehicle.dynamics import Dynamics

_AT_REST = 1e-9
"""Share below which a zero's inverse counts as none: it is at infinity."""


def slowest_zero_time(left: Capability, hull: Dynamics, speed_m_s: float, time_s: float = 0.0) -> float:
    """1 / z [s], z the slowest zero in the right half plane on a level course in trim; 0 where there is none.

    Args:
        left: what the thrusters can do.
        hull: the body.
        speed_m_s: of the course, through the water.
        time_s: of the loop that points the thrust, for the trim that is taken; see `CourseTrims`.
    """
    trims = CourseTrims.of(left, hull, speed_m_s, 0.0, time_s)
    if trims is None:
        return 0.0
    wish = np.eye(3)
    trim = trims.nearest(wish)
    R, found = trims.attitudes.trimmed((wish if trim is None else trim)[None])
    if not found[0]:
        return 0.0
    x = inverse_zeros(left, hull, R[0].T @ trims.attitudes.velocity, R[0, 2])
    return float(np.max(np.abs(x[x.real > _AT_REST * np.max(np.abs(x), initial=1.0)]), initial=0.0))


def inverse_zeros(left: Capability, hull: Dynamics, velocity: Vector, up: Vector) -> NDArray[np.complex128]:
    """Inverses [s] of the zeros from attitude to place, of a steady motion.

    The place e of the hull, in the directions in which forces give way, and its small rotation theta about the axes
    that the water does not hold, obey n' [M nu' + D nu - K theta] = 0 with nu = [e' - theta x v; theta'], n' w the part
    of a wrench w that gives way. So the polynomial of theta is
        n' (M_t s^2 + (M_v S(v) + D_t) s + D_v S(v) - K),
    v and t for velocities and rotations; its zeros are those of its part that moves the hull in the end, s = 0.

    Args:
        left: what the thrusters can do.
        hull: the body.
        velocity: v (3,) [m/s], body axes.
        up: (3,) world up in body axes.
    """
    given_way = np.linalg.solve(left.lost.T @ left.yielding, left.lost.T)
    by_water = np.linalg.norm(left.yielding[3:], axis=0) > 0.0
    n, axes = given_way[~by_water], _complement(left.yielding[3:, by_water])
    M, S = hull.total_mass, skew(velocity)
    D = hull.steady_wrench_slope(np.concatenate([velocity, np.zeros(3)]))
    steady = np.linalg.pinv(n @ (D[:, :3] @ S - hull.restoring_slope(up)) @ axes)
    first, second = n @ (M[:, :3] @ S + D[:, 3:]) @ axes @ steady, n @ M[:, 3:] @ axes @ steady
    # second s^2 + first s + 1 = 0 in x = 1 / s
    one, none = np.eye(len(n)), np.zeros((len(n), len(n)))
    return np.linalg.eigvals(np.block([[none, one], [-second, -first]])).astype(np.complex128)


def _complement(vectors: Matrix) -> Matrix:
    """(3,q) orthonormal axes across those of (3,k)."""
    U, _, _ = np.linalg.svd(vectors)
    return U[:, vectors.shape[1] :]
