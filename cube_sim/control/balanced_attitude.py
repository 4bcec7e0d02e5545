"""Attitude for a vehicle that has lost part of its wrench: turn until force and righting torque come together.

When thrusters die, some combinations of force and torque can no longer be produced. N_f' F + N_t' M = b holds always;
b = 0 unless a thruster is stuck at a force. A force then comes with a torque. In some attitudes that torque is the very
one that holds the hull against its righting moment. There the vehicle pushes where the path needs it and keeps its
attitude. This law steers to such an attitude, and along the family of them as the demand turns. Turning the heading
does most of it, righting moments do the rest.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.attitude_mode import AttitudeMode, DesiredAttitude, Situation
from cube_sim.control.authority import Capability
from cube_sim.control.loop_times import FASTEST_TURN
from cube_sim.spatial import (
    Matrix,
    Vector,
    cross,
    quaternion_from_rotation,
    rotation_about,
    rotation_from_quaternion,
    skew,
)
from cube_sim.vehicle.dynamics import Dynamics

SOFTNESS_N = 0.6
"""Damping of the inverse: forces of this size and less hardly turn the vehicle, as their direction means little."""
SHORTAGE_TIME = 2.0
"""Over which the force that is compared with what is attainable is averaged, and in which the vehicle turns [s]."""


class BalancedAttitude:
    """Two tasks by priority (Nakamura 1987), on the turning rate w of the desired attitude, body axes.

    First, with F = R' F_W and z = R' e_z, the imbalance g = N_f' F + N_t' (M_0 - r x z) - b decays over `time`:
    w = -J# (g / time + N_f' R' F_W'), J = dg/dw = N_f' S(F) - N_t' S(r) S(z). The torque -r x z holds the hull against
    the moment of its buoyancy and weight, r = rho V |g| r_CB - m |g| r_CG. M_0 is all else that has to be held: the
    moment of the flow, and what is estimated on top of it. Second, in the null space of the first, the hull turns to
    the attitude the mission asks for, over `wish_time`. J# is damped, so nothing is singular when the force vanishes or
    lines up with the axis it cannot be turned about.

    Where force and torque exceed what is attainable, the facet they exceed most is one more row of the first task: the
    vehicle turns until they lie within.

    The force is averaged over `time` and led by as much: F = 2 F_1 - F_2, F_1 and F_2 averaged once and twice, and
    F_W' = (F_1 - F_2) / time. A force that turns evenly with the path is so pointed without lag.

    Args:
        left: what the thrusters can still do, and it steers by attitude; in a level plane by heading alone.
        dynamics: of the hull.
        rotation: R_WB (3,3) now, from which the first turn starts.
        time: of the first task, and over which the demanded force is averaged [s].
        wish: the attitude of the second task.
        wish_time: of the second task [s].
        most_rate: bound on the turning of the desired attitude [rad/s].
    """

    def __init__(
        self,
        left: Capability,
        dynamics: Dynamics,
        rotation: Matrix,
        time: float,
        wish: AttitudeMode,
        wish_time: float = 2.0,
        most_rate: float = FASTEST_TURN,
    ) -> None:
        self._forces, self._torques, self._level = left.lost_forces, left.lost_torques, left.level
        self._constants, self._budget = left.constants, left.budget
        self._righting = dynamics.righting_moment
        self._rotation, self._time, self._wish_time = rotation.copy(), time, wish_time
        self._wish, self._most_rate = wish, most_rate
        self._force: Vector | None = None
        self.short, self.off = False, np.inf

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        wish = self._wish.attitude(situation, dt)
        if self._force is None:
            self._force = self._twice = situation.force
            self._slow = situation.force
            self._torque = situation.torque
        share = min(1.0, dt / self._time)
        self._force = self._force + share * (situation.force - self._force)
        self._twice = self._twice + share * (self._force - self._twice)
        self._slow = self._slow + min(1.0, dt / SHORTAGE_TIME) * (situation.force - self._slow)
        self._torque = self._torque + share * (situation.torque - self._torque)
        R = self._rotation
        slope = (self._force - self._twice) / self._time
        rates = self._rates(R.T @ (self._force + self._time * slope), R.T @ slope, R, wish, situation.force_ratio)
        speed = float(np.linalg.norm(rates))
        if speed > self._most_rate:
            rates, speed = rates * (self._most_rate / speed), self._most_rate
        if speed > 0.0:
            self._rotation = R @ rotation_about(rates / speed, speed * dt)
        return DesiredAttitude(quaternion_from_rotation(R), R @ rates)

    def _rates(self, F: Vector, dF: Vector, R: Matrix, wish: DesiredAttitude, force_ratio: float) -> Vector:
        """Turning rate (3,) [rad/s], body axes."""
        z = R[2]
        torque = self._torque - cross(self._righting, z)
        forces, torques = self._forces.T, self._torques.T
        imbalance = (forces @ F + torques @ torque - self._constants) / self._time + forces @ dF
        turning = skew(self._righting) @ skew(z)
        J = forces @ skew(F) - torques @ turning
        if self._budget is not None:
            F = R.T @ self._slow
            excess = self._budget.excess(np.concatenate([F, torque]), force_ratio)
            worst = int(np.argmax(excess))
            self.short = bool(excess[worst] > 0.0)
            if self.short:
                normal = self._budget.attainable.normals[worst]
                J = np.vstack([J, normal[:3] @ skew(F) - normal[3:] @ turning])
                imbalance = np.append(imbalance, excess[worst] / SHORTAGE_TIME)
        if self._level:  # it turns about the vertical only, and no other turn counts as a way out
            J = np.outer(J @ z, z)
        inverse = J.T @ np.linalg.inv(J @ J.T + SOFTNESS_N**2 * np.eye(len(J)))
        error = quaternion_from_rotation(R.T @ rotation_from_quaternion(wish.quaternion))
        self.off = 2.0 * float(np.linalg.norm(error[1:]))
        second = R.T @ wish.rates + 2.0 * error[1:] / self._wish_time
        rates = -inverse @ imbalance + second - inverse @ (J @ second)
        return z * (z @ rates) if self._level else rates
