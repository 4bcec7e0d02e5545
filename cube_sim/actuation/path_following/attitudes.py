"""The attitudes of a body on a straight course: the wrench that keeps each, the nearest whose wrench is producible."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.directions.subspaces import Subspaces
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import Matrix, Vector

_STEPS = 30
_DIFFERENCE = 1e-6
_LONGEST_RAD = 0.5
_SINGULAR = 1e-9
_BALANCED = 1e-8


@dataclass(frozen=True)
class Attitudes:
    """Attitudes R (q,3,3), the body's axes in the world's, of a body on a course at constant velocity.

    Attributes:
        hull: the body.
        velocity: (3,) [m/s], world axes.
        rows: which components of the wrench are looked at, those of the thrusters' A.
        turns: (k,3) the rotations an attitude is free to make: about all body axes, in the plane about z.
        conditions: (d,n) combinations of the wrench that the thrusters cannot produce.
        rounding: how much of a condition counts as none [N].
    """

    hull: Dynamics
    velocity: Vector
    rows: tuple[int, ...]
    turns: Matrix
    conditions: Matrix
    rounding: float

    @staticmethod
    def on(hull: Dynamics, actuation: Subspaces, speed_m_s: float, inclination_rad: float) -> Attitudes:
        """Those on a course at this speed and angle above the horizontal; 3 components are motion in the plane."""
        planar = len(actuation.matrix) == 3
        rows = actuation.axes.rows
        velocity = speed_m_s * np.array([np.cos(inclination_rad), 0.0, np.sin(inclination_rad)])
        level = float(np.linalg.norm(hull.steady_wrenches(velocity[None], np.eye(3)[2:])[:, rows]))
        offset = float(np.linalg.norm(hull.centre_of_buoyancy - hull.centre_of_mass))
        return Attitudes(
            hull=hull,
            velocity=velocity,
            rows=rows,
            turns=np.eye(3)[2:] if planar else np.eye(3),
            conditions=np.array([c.coefficients for c in actuation.unreachable]).reshape(-1, len(rows)),
            rounding=_BALANCED * max(1.0, level, hull.buoyancy * offset),
        )

    def wrenches(self, R: Matrix) -> Matrix:
        """(q,n) what keeps the body on its course in attitudes R [N, N m]."""
        return self.hull.steady_wrenches(self.velocity @ R, R[:, 2])[:, self.rows]

    def slopes(self, R: Matrix) -> Matrix:
        """(q,n,k) derivatives of the wrenches by the turns [N/rad, N m/rad]."""
        still, slight = self.wrenches(R), _DIFFERENCE * np.eye(len(self.turns))
        return np.stack(
            [(self.wrenches(self.turned(R, turn)) - still) / _DIFFERENCE for turn in slight[:, None]], axis=2
        )

    def turned(self, R: Matrix, by: Matrix) -> Matrix:
        """(q,3,3) attitudes R turned by angles (q,k) about the body's axes [rad]."""
        return R @ rotations(by @ self.turns)

    def producible(self, R: Matrix) -> tuple[Matrix, NDArray[np.bool_]]:
        """Newton steps of least norm to attitudes whose wrench the thrusters produce, limits not looked at.

        Args:
            R: (q,3,3) to start from.

        Returns:
            (q,3,3) the attitudes, and (q,) whether each is one: not all starts lead to one.
        """
        R, left = R.copy(), np.arange(len(R))
        for _ in range(_STEPS):
            error = self.wrenches(R[left]) @ self.conditions.T
            off = np.linalg.norm(error, axis=1) > self.rounding
            left, error = left[off], error[off]
            if not len(left):
                break
            step = -np.einsum("qkd,qd->qk", np.linalg.pinv(self.conditions @ self.slopes(R[left]), _SINGULAR), error)
            length = np.maximum(np.linalg.norm(step, axis=1, keepdims=True), np.finfo(float).tiny)
            R[left] = self.turned(R[left], step * np.minimum(1.0, _LONGEST_RAD / length))
        return R, ~np.isin(np.arange(len(R)), left)


def rotations(vectors: Matrix) -> Matrix:
    """(q,3,3) exp(S(vector)) of vectors (q,3)."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()
