"""Attitude for a vehicle that has lost part of its wrench: turn until force and righting torque come together.

When thrusters die, some combinations of force and torque can no longer be produced. N_f' F + N_t' M = b holds always;
b = 0 unless a thruster is stuck at a force. A force then comes with a torque. In some attitudes that torque is the very
one that holds the hull against its righting moment. There the vehicle pushes where the path needs it and keeps its
attitude. This law steers to such an attitude, and along the family of them as the demand turns. Turning the heading
does most of it, righting moments do the rest.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.control.authority import Capability
from cube_sim.control.levelling import UP
from cube_sim.spatial import Matrix, Vector, cross, quaternion_from_rotation, rotation_about, skew
from cube_sim.vehicle.dynamics import Dynamics

SOFTNESS_N = 0.6
"""Damping of the inverse: forces of this size and less hardly turn the vehicle, as their direction means little."""
MAX_RATE = 1.0
"""Bound on the turning of the desired attitude [rad/s]."""


class BalancedAttitude:
    """Two tasks by priority (Nakamura 1987), on the turning rate w of the desired attitude, body axes.

    First, with F = R' F_W and z = R' e_z, the imbalance g = N_f' F + N_t' M_hold(z) - b decays over `time`:
    w = -J# g / time, J = dg/dw = N_f' S(F) - N_t' S(r) S(z), where M_hold = -r x z holds the hull against the moment
    r = rho V |g| r_CB - m |g| r_CG of its buoyancy and weight. Second, in the null space of the first, the hull rights
    itself over `levelling_time`: w_level = e_z x z / levelling_time. Both J# are damped, so nothing is singular when
    the force vanishes or lines up with the axis it cannot be turned about.

    Args:
        left: what the thrusters can still do, and it steers by attitude; in a level plane by heading alone.
        dynamics: of the hull.
        rotation: R_WB (3,3) now, from which the first turn starts.
        time: of the first task, and over which the demanded force is averaged [s].
        levelling_time: of the second [s].
    """

    def __init__(
        self, left: Capability, dynamics: Dynamics, rotation: Matrix, time: float, levelling_time: float = 2.0
    ) -> None:
        self._forces, self._torques, self._level = left.lost_forces, left.lost_torques, left.level
        self._constants = left.constants
        self._righting = dynamics.righting_moment
        self._rotation, self._time, self._levelling_time = rotation.copy(), time, levelling_time
        self._force: Vector | None = None

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        if self._force is None:
            self._force = situation.force
        self._force = self._force + min(1.0, dt / self._time) * (situation.force - self._force)
        R = self._rotation
        rates = self._rates(R.T @ self._force, R[2])
        speed = float(np.linalg.norm(rates))
        if speed > MAX_RATE:
            rates, speed = rates * (MAX_RATE / speed), MAX_RATE
        if speed > 0.0:
            self._rotation = R @ rotation_about(rates / speed, speed * dt)
        return DesiredAttitude(quaternion_from_rotation(R), R @ rates)

    def _rates(self, F: Vector, z: Vector) -> Vector:
        imbalance = self._forces.T @ F - self._torques.T @ cross(self._righting, z) - self._constants
        J = self._forces.T @ skew(F) - self._torques.T @ skew(self._righting) @ skew(z)
        inverse = J.T @ np.linalg.inv(J @ J.T + SOFTNESS_N**2 * np.eye(len(J)))
        level = cross(UP, z) / self._levelling_time
        rates = -inverse @ imbalance / self._time + level - inverse @ (J @ level)
        return z * (z @ rates) if self._level else rates
