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
FARTHEST_RAD = 0.7
"""A hull that is this far from the attitude found is held by its water elsewhere: the search goes on from there."""


class BalancedAttitude:
    """Two tasks by priority (Nakamura 1987), on the turning rate w of the desired attitude R, body axes.

    What has to be made in an attitude is the wrench W(R) = W_s(R' U, R' e_z) + [R' F_W; M_0]. W_s keeps the wanted
    velocity U through the water steady: drag, Munk moment, weight and lift. It turns with the hull, as the water
    meets it from another side. F_W is the rest of the force, to change the velocity and against disturbances; its
    direction is that of the world. M_0 is the torque against disturbances and for the turning that goes on.

    First, the imbalance g = N' W - b decays over `time`: w = -J# (g / time + N' W'), J = dg/dw, W' that of U and F_W as
    the path turns. Second, in the null space of the first, the hull turns to the attitude the mission asks for, over
    `wish_time`. J# is damped, so nothing is singular when the force vanishes or lines up with the axis it cannot be
    turned about.

    Where W exceeds what is attainable, the facet it exceeds most is one more row of the first task: the vehicle turns
    until it lies within.

    U and F_W are averaged over `time` and led by as much: x = 2 x_1 - x_2, x_1 and x_2 averaged once and twice, and
    x' = (x_1 - x_2) / time. A force that turns evenly with the path is so pointed without lag.

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
        self._lost, self._level = left.lost, left.level
        self._constants, self._budget = left.constants, left.budget
        self._dynamics = dynamics
        self._rotation, self._time, self._wish_time = rotation.copy(), time, wish_time
        self._wish, self._most_rate = wish, most_rate
        self._led: Matrix | None = None
        self.short, self.off = False, np.inf

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        wish = self._wish.attitude(situation, dt)
        demand = np.array([situation.flow, situation.force - self._steady_force(situation)])
        if self._led is None:
            self._led = self._twice = self._slow = demand
            self._torque = situation.torque
        share = min(1.0, dt / self._time)
        self._led = self._led + share * (demand - self._led)
        self._twice = self._twice + share * (self._led - self._twice)
        self._slow = self._slow + min(1.0, dt / SHORTAGE_TIME) * (demand - self._slow)
        self._torque = self._torque + share * (situation.torque - self._torque)
        if _angle_between(self._rotation, situation.rotation) > FARTHEST_RAD:
            self._rotation = situation.rotation.copy()
        R = self._rotation
        slope = (self._led - self._twice) / self._time
        rates = self._rates((self._led + self._time * slope) @ R, slope @ R, R, wish, situation.force_ratio)
        speed = float(np.linalg.norm(rates))
        if speed > self._most_rate:
            rates, speed = rates * (self._most_rate / speed), self._most_rate
        if speed > 0.0:
            self._rotation = R @ rotation_about(rates / speed, speed * dt)
        return DesiredAttitude(quaternion_from_rotation(R), R @ rates)

    def _steady_force(self, situation: Situation) -> Vector:
        """The force (3,) [N], world axes, of the wanted velocity in the attitude the hull has."""
        R = situation.rotation
        return R @ self._dynamics.steady_wrenches((situation.flow @ R)[None], R[2:])[0, :3]

    def _wrench(self, demand: Matrix, up: Vector) -> Vector:
        """W (6,) [N, N m] for U and F_W (2,3) in body axes."""
        wrench = self._dynamics.steady_wrenches(demand[:1], up[None])[0]
        return wrench + np.concatenate([demand[1], self._torque])

    def _rates(self, demand: Matrix, change: Matrix, R: Matrix, wish: DesiredAttitude, force_ratio: float) -> Vector:
        """Turning rate (3,) [rad/s], body axes, for U and F_W (2,3) and their derivatives (2,3) in body axes."""
        z, N = R[2], self._lost.T
        by_velocity = self._dynamics.steady_wrench_slope(np.concatenate([demand[0], np.zeros(3)]))[:, :3]
        changing = by_velocity @ change[0] + np.concatenate([change[1], np.zeros(3)])
        imbalance = (N @ self._wrench(demand, z) - self._constants) / self._time + N @ changing
        turning = by_velocity @ skew(demand[0]) - self._dynamics.restoring_slope(z)
        turning[:3] += skew(demand[1])
        J = N @ turning
        if self._budget is not None:
            excess = self._budget.excess(self._wrench(self._slow @ R, z), force_ratio)
            worst = int(np.argmax(excess))
            self.short = bool(excess[worst] > 0.0)
            if self.short:
                J = np.vstack([J, self._budget.attainable.normals[worst] @ turning])
                imbalance = np.append(imbalance, excess[worst] / SHORTAGE_TIME)
        if self._level:  # it turns about the vertical only, and no other turn counts as a way out
            J = np.outer(J @ z, z)
        inverse = J.T @ np.linalg.inv(J @ J.T + SOFTNESS_N**2 * np.eye(len(J)))
        error = quaternion_from_rotation(R.T @ rotation_from_quaternion(wish.quaternion))
        self.off = 2.0 * float(np.linalg.norm(error[1:]))
        second = R.T @ wish.rates + 2.0 * error[1:] / self._wish_time
        rates = -inverse @ imbalance + second - inverse @ (J @ second)
        return z * (z @ rates) if self._level else rates


def _angle_between(a: Matrix, b: Matrix) -> float:
    """The angle of the rotation from one attitude (3,3) to another [rad]."""
    return float(np.arccos(np.clip((np.trace(a.T @ b) - 1.0) / 2.0, -1.0, 1.0)))
