"""Trim: attitudes in which the thrusters can make the wrench that keeps a straight course; limits are not looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import Matrix, Vector

_HEADINGS = 8
_NEWTON_STEPS = 30
_DIFFERENCE_RAD = 1e-6
_LONGEST_RAD = 0.5
_SINGULAR = 1e-9
_BALANCED = 1e-8


@dataclass(frozen=True)
class TrimCondition:
    """A straight course at constant velocity and attitude, and what keeps it.

    Attributes:
        inclination_rad: angle of the course above the horizontal.
        velocity: v (3,) [m/s], body axes.
        up: R_WB' e_z (3,), world up in body axes.
        wrench: F_B (n,) that keeps it [N, N m].
        forces: F_m = A^+ F_B (m,) [N], the thruster forces of least norm; limits are not looked at.
    """

    inclination_rad: float
    velocity: Vector
    up: Vector
    wrench: Vector
    forces: Vector

    @property
    def tilt_rad(self) -> float:
        """Angle between the body's z axis and the vertical."""
        return float(np.arctan2(np.hypot(self.up[0], self.up[1]), self.up[2]))


def trim_conditions(
    hull: Dynamics, actuation: Subspaces, speed_m_s: float, inclination_rad: float, *, inclined: bool = False
) -> tuple[TrimCondition, ...]:
    """Trim conditions of a course, the one nearest to level for each heading tried.

    The unknown is the attitude. The equations are the combinations of the steady wrench that the thrusters cannot
    produce. Newton's method starts level, with the body's x axis at equally spaced angles from the course.

    Args:
        hull: the body.
        actuation: of the thrusters that are left.
        speed_m_s: speed over the course.
        inclination_rad: angle of the course above the horizontal.
        inclined: start with the body's deck along the course, not level.
    """
    pitch = rotations(np.array([[0.0, -inclination_rad if inclined else 0.0, 0.0]]))
    headings = 2.0 * np.pi * np.arange(_HEADINGS) / _HEADINGS
    attitudes = CourseAttitudes.on(hull, actuation, speed_m_s, inclination_rad)
    R, in_trim = attitudes.trimmed(pitch @ rotations(np.outer(headings, [0.0, 0.0, 1.0])))
    return conditions_at(attitudes, R[in_trim], actuation, inclination_rad)


@dataclass(frozen=True)
class CourseAttitudes:
    """Attitudes of a body on a course at constant velocity.

    An attitude R (3,3) has the body's axes in those of the course: x along its horizontal direction, z up.

    Attributes:
        hull: the body.
        velocity: (3,) [m/s], axes of the course.
        rows: which components of the wrench are looked at, those of the thrusters' A.
        turns: (k,3) the rotations an attitude is free to make: about all body axes, in the plane about z.
        unreachable: (d,n) combinations of the wrench that the thrusters cannot produce [1] for forces, [1/m] for
            torques.
        rounding: how much of such a combination counts as none [N].
        turning_rad_s: rate at which the course turns about the vertical; 0 where it is straight.
    """

    hull: Dynamics
    velocity: Vector
    rows: tuple[int, ...]
    turns: Matrix
    unreachable: Matrix
    rounding: float
    turning_rad_s: float = 0.0

    @staticmethod
    def on(hull: Dynamics, actuation: Subspaces, speed_m_s: float, inclination_rad: float) -> CourseAttitudes:
        """Those on a course at this speed and angle above the horizontal; 3 components are motion in the plane."""
        unreachable = np.array([c.coefficients for c in actuation.unreachable]).reshape(-1, len(actuation.matrix))
        return CourseAttitudes.without(hull, unreachable.T, actuation.axes.rows, speed_m_s, inclination_rad)

    @staticmethod
    def without(
        hull: Dynamics, lost: Matrix, rows: tuple[int, ...], speed_m_s: float, inclination_rad: float = 0.0
    ) -> CourseAttitudes:
        """Those of a body whose thrusters cannot make some combinations of its wrench.

        Args:
            hull: the body.
            lost: (n,d) the combinations.
            rows: which components of the wrench these are of; three are motion in the plane.
            speed_m_s: over the course.
            inclination_rad: angle of the course above the horizontal.
        """
        planar = len(rows) == 3
        velocity = speed_m_s * np.array([np.cos(inclination_rad), 0.0, np.sin(inclination_rad)])
        level = float(np.linalg.norm(hull.steady_wrenches(velocity[None], np.eye(3)[2:])[:, rows]))
        offset = float(np.linalg.norm(hull.centre_of_buoyancy - hull.centre_of_mass))
        return CourseAttitudes(
            hull=hull,
            velocity=velocity,
            rows=rows,
            turns=np.eye(3)[2:] if planar else np.eye(3),
            unreachable=np.ascontiguousarray(lost.T),
            rounding=_BALANCED * max(1.0, level, hull.buoyancy * offset),
        )

    def wrenches(self, R: Matrix) -> Matrix:
        """(q,n) what keeps the body on its course in attitudes R (q,3,3) [N, N m]."""
        if self.turning_rad_s:
            nus = np.hstack([self.velocity @ R, self.turning_rad_s * R[:, 2]])
            return self.hull.turning_wrenches(nus, R)[:, self.rows]
        return self.hull.steady_wrenches(self.velocity @ R, R[:, 2])[:, self.rows]

    def slopes(self, R: Matrix) -> Matrix:
        """(q,n,k) derivatives of the wrenches by the turns [N/rad, N m/rad], as differences."""
        still, slight = self.wrenches(R), _DIFFERENCE_RAD * np.eye(len(self.turns))
        return np.stack(
            [(self.wrenches(self.turned(R, turn)) - still) / _DIFFERENCE_RAD for turn in slight[:, None]], axis=2
        )

    def turned(self, R: Matrix, by: Matrix) -> Matrix:
        """(q,3,3) attitudes R turned by angles (q,k) about the body's axes [rad]."""
        return R @ rotations(by @ self.turns)

    def trimmed(self, R: Matrix) -> tuple[Matrix, NDArray[np.bool_]]:
        """Newton steps of least norm to attitudes in trim: their wrench has nothing of what the thrusters cannot do.

        Args:
            R: (q,3,3) to start from.

        Returns:
            (q,3,3) the attitudes, and (q,) whether each is in trim: not all starts lead to one that is.
        """
        R, left = R.copy(), np.arange(len(R))
        for _ in range(_NEWTON_STEPS):
            error = self.wrenches(R[left]) @ self.unreachable.T
            off = np.linalg.norm(error, axis=1) > self.rounding
            left, error = left[off], error[off]
            if not len(left):
                break
            step = -np.einsum("qkd,qd->qk", np.linalg.pinv(self.unreachable @ self.slopes(R[left]), _SINGULAR), error)
            length = np.maximum(np.linalg.norm(step, axis=1, keepdims=True), np.finfo(float).tiny)
            R[left] = self.turned(R[left], step * np.minimum(1.0, _LONGEST_RAD / length))
        return R, ~np.isin(np.arange(len(R)), left)


def conditions_at(
    attitudes: CourseAttitudes, R: Matrix, actuation: Subspaces, inclination_rad: float
) -> tuple[TrimCondition, ...]:
    """The trim condition in each of the attitudes R (q,3,3) of a course at this angle above the horizontal."""
    return tuple(
        TrimCondition(inclination_rad, attitudes.velocity @ r, r[2], wrench, actuation.pseudo_inverse @ wrench)
        for r, wrench in zip(R, attitudes.wrenches(R), strict=True)
    )


def rotations(vectors: Matrix) -> Matrix:
    """(q,3,3) exp(S(vector)) of rotation vectors (q,3) [rad]."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()
