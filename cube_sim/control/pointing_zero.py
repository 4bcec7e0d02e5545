"""How fast a force may be asked for that has to be pointed first.

A hull that turns to point its force is pushed the wrong way at first where the torque for turning comes with a force,
or where it has more added mass along its course than across. From attitude to place the transfer function then has
zeros in the right half plane, and no loop around it can be faster than the slowest of them (J. S. Freudenberg and
D. P. Looze, IEEE TAC 30, 1985).

A hull that turns fast meets more drag for each radian per second. What its stern has to push against that is the longer
in coming back: the zeros are slower, the faster it turns.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cube_sim.control.authority import Capability
from cube_sim.spatial import Matrix, Vector, skew
from cube_sim.vehicle.dynamics import Dynamics

A_THIRD_AS_FAST = 3.0
"""A loop around what it sees is to cross over below half of its slowest zero in the right half plane (S. Skogestad and
I. Postlethwaite, Multivariable Feedback Control, 2005, section 5.7). At half of it hulls of five thrusters without two
have 4 and 5 dB left, and dead zones and limits throw them off; at a third 7 and 15 dB (measured)."""
EASED = 2.0
"""A hull turns no faster than where its zeros are this many times slower than its velocity loop (a choice)."""
BISECTED = 12
"""Times the interval of rates is halved in which that one lies."""
SAME = 1e-3
"""Share by which two zeros differ that are one."""
_AT_REST = 1e-9
"""Share below which a zero's inverse counts as none: it is at infinity."""


def zero_time(left: Capability, hull: Dynamics, velocity: Vector, up: Vector) -> float:
    """How slow a velocity loop has to be for the zeros in the right half plane of a steady motion [s].

    1 / z for the slowest of the hull's place, 3 / z for one that its centre of oscillation has alone; 0 where there is
    none. Arguments as for `inverse_zeros`.
    """
    of_hull = inverse_zeros(left, hull, velocity, up)
    of_centre = inverse_zeros(left, hull, velocity, up, centre=True)
    apart = np.abs(of_centre[:, None] - of_hull).min(axis=1) > SAME * np.abs(of_centre)
    return max(_slowest(of_hull), A_THIRD_AS_FAST * _slowest(of_centre[apart]))


def most_turning(
    left: Capability, hull: Dynamics, velocity: Vector, up: Vector, velocity_time: float, most: float
) -> float:
    """How fast a hull may turn for its velocity loop to be slow enough for the zeros there [rad/s].

    A loop whose zeros have become slower than it is turns the hull to and fro, as far as its thrusters can. Nor may
    turning push it faster than it goes: the water then meets it from another side than the attitude is found for, and
    the search passes over the trim that was to be taken.

    Args:
        left: as for `inverse_zeros`, like the next three.
        hull: see there.
        velocity: see there.
        up: see there.
        velocity_time: of the velocity loop [s].
        most: as fast as it turns at all [rad/s].
    """

    def eased(rate: float) -> bool:
        return zero_time(left, turning_fast(hull, rate), velocity, up) <= EASED * velocity_time

    pushed = float(np.linalg.norm(dragged_along(left, hull), ord=2))
    if pushed > 0.0:
        most = min(most, float(np.linalg.norm(velocity)) / pushed)
    if eased(most):
        return most
    slow, fast = 0.0, most
    for _ in range(BISECTED):
        middle = 0.5 * (slow + fast)
        slow, fast = (middle, fast) if eased(middle) else (slow, middle)
    return slow


def dragged_along(left: Capability, hull: Dynamics) -> Matrix:
    """(3,3) [m]: how far turning drags the hull along, by the force that comes with its torque."""
    M = hull.total_mass
    return np.asarray(np.linalg.solve(M[:3, :3], left.dragged_force @ M[3:, 3:]), dtype=np.float64)


def turning_fast(hull: Dynamics, rate: float) -> Dynamics:
    """The hull with the drag per radian per second that it meets where it turns at a rate [rad/s]."""
    more = np.zeros((6, 6))
    more[:, 3:] = rate * hull.quadratic_damping[:, 3:]
    return replace(hull, linear_damping=hull.linear_damping + more)


def _slowest(inverse: NDArray[np.complex128]) -> float:
    """The largest of these inverses of zeros that is in the right half plane [s]; 0 where none is."""
    return float(np.max(np.abs(inverse[inverse.real > _AT_REST * np.max(np.abs(inverse), initial=1.0)]), initial=0.0))


def inverse_zeros(
    left: Capability, hull: Dynamics, velocity: Vector, up: Vector, centre: bool = False
) -> NDArray[np.complex128]:
    """Inverses [s] of the zeros from attitude to place, of a steady motion.

    The place e of the hull, in the directions in which forces give way, and its small rotation theta about the axes
    that the water does not hold, obey n' [M nu' + D nu - K theta] = 0 with nu = [e' - theta x v; theta'], n' w the part
    of a wrench w that gives way. So the polynomial of theta is
        n' (M_t s^2 + (M_v S(v) + D_t) s + D_v S(v) - K),
    v and t for velocities and rotations; its zeros are those of its part that moves the hull in the end, s = 0.
    The place that the loops see and correct is that of the centre of oscillation, e - d theta, d what a turn drags
    along. It is not pushed by the turn itself, which takes M_t s^2 away with M_v d s^2; but what the hull is pushed by
    meets drag, D_v d s. That is a zero of its own, the slower, the less force a turn brings in the end.

    Args:
        left: what the thrusters can do.
        hull: the body.
        velocity: v (3,) [m/s], body axes.
        up: (3,) world up in body axes.
        centre: of the place of the centre of oscillation.
    """
    given_way = np.linalg.solve(left.lost.T @ left.yielding, left.lost.T)
    by_water = np.linalg.norm(left.yielding[3:], axis=0) > 0.0
    n, axes = given_way[~by_water], _complement(left.yielding[3:, by_water])
    M, S = hull.total_mass, skew(velocity)
    D = hull.steady_wrench_slope(np.concatenate([velocity, np.zeros(3)]))
    steady = np.linalg.pinv(n @ (D[:, :3] @ S - hull.restoring_slope(up)) @ axes)
    dragged = dragged_along(left, hull) if centre else np.zeros((3, 3))
    first = n @ (M[:, :3] @ S + D[:, 3:] + D[:, :3] @ dragged) @ axes @ steady
    second = n @ (M[:, 3:] + M[:, :3] @ dragged) @ axes @ steady
    # second s^2 + first s + 1 = 0 in x = 1 / s
    one, none = np.eye(len(n)), np.zeros((len(n), len(n)))
    return np.linalg.eigvals(np.block([[none, one], [-second, -first]])).astype(np.complex128)


def _complement(vectors: Matrix) -> Matrix:
    """(3,q) orthonormal axes across those of (3,k)."""
    U, _, _ = np.linalg.svd(vectors)
    return U[:, vectors.shape[1] :]
