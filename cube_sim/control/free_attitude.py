"""The attitude of least effort: the vehicle turns to where its thrusters have least to do."""

from __future__ import annotations

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.spatial import Matrix, Vector, cross, quaternion_from_rotation, rotation_about
from cube_sim.vehicle.dynamics import Dynamics

MAX_RATE = 0.5
"""Bound on the turning of the desired attitude [rad/s]."""
SOFTNESS_N = 1.0
"""Efforts of this size and less hardly turn the vehicle."""
DAMPING = 0.2
"""Share of the effort that is added to its curvature."""
STEP = 1e-6
"""Of the differences [rad]."""

_TURNS = np.array([rotation_about(axis, STEP) for axis in np.eye(3)])
_UNIT, _REST = np.eye(3), np.zeros(6)


class FreeAttitude:
    """Damped Gauss-Newton descent of the effort E = w' Q w over attitudes, Q = (A A')^+, at the pace of T.

    E is the least |f|^2 [N^2] of thruster forces that make the wrench w; dead zones and limits are ignored. w(R) is the
    wrench the motion needs in the attitude R, at the present velocity over ground and in the present current. It has
    three parts: the drag of the hull turned that way, the torque that holds it against its righting moment, and the
    rest of the force demanded now, which stands still in the world. Forces and velocities are averaged over T before.

    By torques alone a hull upside down rests as well as an upright one. So its potential energy |r| - r z counts like a
    torque of that size; r is the righting moment at a right angle, z = R' e_z. Beyond a right angle the righting moment
    falls again, and the hull could hang there. It is therefore turned back at the pace 1 / T.

    Args:
        dynamics: the controller's knowledge of the hull.
        time: T [s], several times that of the attitude loop.
    """

    def __init__(self, dynamics: Dynamics, time: float) -> None:
        self._dynamics, self._time = dynamics, time
        self._effort: Matrix | None = None
        self._righting = dynamics.righting_moment
        self._lift = float(np.linalg.norm(self._righting))
        self._rotation: Matrix | None = None
        self._force, self._velocity = np.zeros(3), np.zeros(3)

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The desired attitude, from the vehicle's own at the first call on, and how it turns."""
        velocity = situation.view.point.rotation @ situation.view.velocity
        if self._rotation is None:
            self._rotation, self._force, self._velocity = situation.rotation, situation.force, velocity
        if situation.effort is not self._effort:
            self._set_effort(situation.effort)
        share = min(1.0, dt / self._time)
        self._force = self._force + share * (situation.force - self._force)
        self._velocity = self._velocity + share * (velocity - self._velocity)
        R = self._rotation
        rates = self._descent(R, situation) + self._righting_rate(R[2])
        speed = float(np.linalg.norm(rates))
        if speed > MAX_RATE:
            rates, speed = rates * (MAX_RATE / speed), MAX_RATE
        if speed > 0.0:
            self._rotation = R @ rotation_about(rates / speed, speed * dt)
        return DesiredAttitude(quaternion_from_rotation(R), R @ rates)

    def _set_effort(self, effort: Matrix) -> None:
        """Take Q (6,6) of the thrusters that work from now on."""
        self._effort = effort
        sizes, axes = np.linalg.eigh(effort)
        self._root = (axes * np.sqrt(np.maximum(sizes, 0.0))).T  # root' root = Q
        self._lift_root = float(np.sqrt(np.trace(effort[3:, 3:]) / 3.0))

    def _descent(self, R: Matrix, situation: Situation) -> Vector:
        """Turning rate (3,) [rad/s], body axes."""
        current = situation.current
        known = self._steady_wrench(situation.rotation, current)
        rest = self._force - situation.rotation @ known[:3]
        y = self._efforts(R, current, rest)
        slopes = np.array([(self._efforts(R @ turn, current, rest) - y) / STEP for turn in _TURNS])  # J'
        damping = DAMPING * float(y @ y) + SOFTNESS_N**2
        step = np.linalg.solve(slopes @ slopes.T + damping * _UNIT, slopes @ y)
        return np.asarray(-step / self._time, dtype=np.float64)

    def _efforts(self, R: Matrix, current: Vector, rest: Vector) -> Vector:
        """y (7,) [N], whose square is E and the share of the potential energy."""
        wrench = self._steady_wrench(R, current)
        wrench[:3] += rest @ R
        y = np.empty(7)
        y[:6] = self._root @ wrench
        y[6] = self._lift_root * (self._lift - float(self._righting @ R[2]))
        return y

    def _steady_wrench(self, R: Matrix, current: Vector) -> Vector:
        """The wrench (6,) that keeps the hull going as it goes, without turning, body axes."""
        nu = np.zeros(6)
        nu[:3] = self._velocity @ R
        return self._dynamics.wrench(R, nu, _REST, current)

    def _righting_rate(self, z: Vector) -> Vector:
        """The rate that turns a hull back which lies beyond a right angle (3,) [rad/s], body axes."""
        if not self._lift > 0.0:
            return np.zeros(3)
        upright = self._righting / self._lift
        if upright @ z >= 0.0:
            return np.zeros(3)
        normal = cross(upright, z)
        sine = float(np.linalg.norm(normal))
        if not sine > 1e-6:
            normal = cross(upright, np.roll(upright, 1) + np.array([0.0, 1.0, 0.0]))  # any one will do
            return normal / float(np.linalg.norm(normal)) / self._time
        return normal * ((1.0 - sine) / (sine * self._time))
