"""An attitude that keeps a body axis on a fixed point of the world."""

from __future__ import annotations

from math import atan2

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.control.levelling import levelling_spin
from cube_sim.spatial import Matrix, Vector, cross, quaternion_from_rotation, rotation_about

MAX_RATE = 1.0
"""Bound on each of the two turns of the desired attitude [rad/s]."""


class LookAt:
    """Two tasks by priority (Nakamura 1987) on the angular velocity w of the desired attitude, world axes.

    First, the axis u = R a comes onto the line of sight l and stays there. As u' = w x u, J1 = -S(u) and J1# = S(u);
    w_1 = l x l' + psi n / T less its part along u, where psi n is the shortest turn from u to l. Second, in the null
    space of the first, I - J1# J1 = u u', the vehicle rolls level about u, as along a path.

    The angle psi decays with the time constant T, whichever way the vehicle faced. The direction of the point means
    little near the point: there w_1 is faded out, to nothing at the point itself. Straight above and below it the roll
    is left alone.

    Args:
        point: (3,) [m], world axes.
        axis: a (3,), unit, body axes.
        near: distance of the point within which w_1 is faded out [m].
        time: T [s].
        levelling_time: of the second task [s].
    """

    def __init__(self, point: Vector, axis: Vector, near: float, time: float, levelling_time: float = 2.0) -> None:
        self._point, self._axis, self._near = point, axis, near
        self._time, self._levelling_time = time, levelling_time
        side = cross(np.array([0.0, 0.0, 1.0]), axis)  # level and to the left of someone who looks along the axis
        size = float(np.linalg.norm(side))
        self._side = side / size if size > 1e-6 else np.array([0.0, 1.0, 0.0])
        self._rotation: Matrix | None = None

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The desired attitude, from the vehicle's own at the first call on, and how it turns."""
        R = situation.rotation if self._rotation is None else self._rotation
        u, side = R @ self._axis, R @ self._side
        first = self._towards_the_point(u, side, situation)
        spin = levelling_spin(u, cross(first, u), side, self._levelling_time)
        spin = min(max(spin, -MAX_RATE), MAX_RATE)
        size = float(np.linalg.norm(first))
        rolled = rotation_about(u, spin * dt) @ R  # first, as it leaves u where it is: the tasks do not mix in a tick
        self._rotation = rotation_about(first / size, size * dt) @ rolled if size > 0.0 else rolled
        return DesiredAttitude(quaternion_from_rotation(R), first + spin * u)

    def _towards_the_point(self, u: Vector, side: Vector, situation: Situation) -> Vector:
        """w_1 (3,) [rad/s], bounded."""
        view = situation.view
        sight = self._point - view.point.position - view.point.rotation @ view.error
        velocity = view.point.rotation @ view.velocity
        distance = float(np.linalg.norm(sight))
        if not distance > 1e-6 * self._near:
            return np.zeros(3)
        line = sight / distance
        turning = cross(velocity, line) / distance  # l x l' with l' = -(v - l l' v) / distance
        w = turning + shortest_turn(u, line, side) / self._time
        near = min(1.0, distance / self._near)
        w = near**2 * (3.0 - 2.0 * near) * (w - u * (u @ w))
        size = float(np.linalg.norm(w))
        return w if size <= MAX_RATE else w * (MAX_RATE / size)


def shortest_turn(a: Vector, b: Vector, axis_if_opposite: Vector) -> Vector:
    """Rotation vector (3,) [rad] that takes one unit vector to another."""
    normal = cross(a, b)
    sine, cosine = float(np.linalg.norm(normal)), float(a @ b)
    if sine > 1e-9:
        return normal * (atan2(sine, cosine) / sine)
    return np.pi * axis_if_opposite if cosine < 0.0 else np.zeros(3)
