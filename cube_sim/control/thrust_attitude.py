"""Attitude for a vehicle that has lost a direction of force: turn what is left towards the force that is wanted.

When thrusters die, the forces that can be produced without torque shrink to a plane or to a line fixed in the body. All
torques may still be there. The vehicle then goes on following its path as a steered one: its attitude is no longer
free but brings that plane or line onto the demanded force, over the heading as long as heading alone can do it, because
buoyancy rights the hull and every tilt costs a steady torque.
"""

from __future__ import annotations

from math import acos, atan2, hypot, pi

import numpy as np

from cube_sim.control.attitude import DesiredAttitude
from cube_sim.guidance.virtual_target import TargetView
from cube_sim.spatial import Matrix, Vector, cross, quaternion_from_rotation, rotation_about

LEAST_FORCE_N = 1.0
"""Demands smaller than this say nothing about a direction: the attitude is kept."""


class PointThrust:
    """Keeps R P, the producible pure forces in world axes, on the demanded force.

    Args:
        pure_forces: P (3,p) orthonormal columns in body axes, p = 1 (a line) or 2 (a plane).
        heading: of the body now [rad], from which the first turn starts.
        time: over which the demanded force is averaged [s]; the heading turns at up to 1 / time [rad/s].
    """

    def __init__(self, pure_forces: Matrix, heading: float, time: float) -> None:
        if pure_forces.shape[1] not in (1, 2):
            raise ValueError(f"pure forces span {pure_forces.shape[1]} dimensions; a line or a plane can be pointed")
        self._plane = pure_forces.shape[1] == 2
        # A plane is kept by its normal, which must stand across the force; a line by its direction.
        self._axis = cross(pure_forces[:, 0], pure_forces[:, 1]) if self._plane else pure_forces[:, 0]
        self._heading, self._time = heading, time
        self._force: Vector | None = None
        self._heading_rate = 0.0

    def attitude(self, view: TargetView, force_W: Vector, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        if self._force is None:
            self._force = force_W
        self._force = self._force + min(1.0, dt / self._time) * (force_W - self._force)
        before = self._heading
        if hypot(self._force[0], self._force[1]) > LEAST_FORCE_N:
            self._turn_towards(self._force, dt)
        rate = (self._heading - before) / dt
        self._heading_rate += min(1.0, dt / self._time) * (rate - self._heading_rate)
        R = rotation_about(np.array([0.0, 0.0, 1.0]), self._heading)
        if float(np.linalg.norm(self._force)) > LEAST_FORCE_N:
            R = self._tilt(R, self._force) @ R
        return DesiredAttitude(quaternion_from_rotation(R), np.array([0.0, 0.0, self._heading_rate]))

    def _turn_towards(self, force: Vector, dt: float) -> None:
        """Of the two headings that serve, take the nearer one, and go there no faster than the limit."""
        across = hypot(self._axis[0], self._axis[1])
        if across < 1e-6:
            return  # the axis is vertical: heading moves nothing
        bearing = atan2(force[1], force[0]) - atan2(self._axis[1], self._axis[0])
        if self._plane:
            # n_h F_h cos(turn) + n_z F_z = 0
            cosine = -self._axis[2] * force[2] / (across * hypot(force[0], force[1]))
            turn = acos(min(max(cosine, -1.0), 1.0))
            candidates = (bearing + turn, bearing - turn)
        else:
            candidates = (bearing, bearing + pi)  # thrusters push both ways
        steps = [(heading - self._heading + pi) % (2.0 * pi) - pi for heading in candidates]
        step = min(steps, key=abs)
        most = dt / self._time
        self._heading += min(max(step, -most), most)

    def _tilt(self, R: Matrix, force: Vector) -> Matrix:
        """The smallest rotation that finishes what the heading began."""
        direction = force / np.linalg.norm(force)
        axis_W = R @ self._axis
        cosine = float(axis_W @ direction)
        about = cross(axis_W, direction)
        sine = float(np.linalg.norm(about))
        if sine < 1e-9:
            return np.eye(3)
        if self._plane:
            angle = atan2(sine, cosine) - 0.5 * pi
        else:
            angle = atan2(sine, cosine) if cosine >= 0.0 else atan2(sine, cosine) - pi
        return rotation_about(about / sine, angle)
