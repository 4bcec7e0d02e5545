"""What the thrusters still working can do for path following, and how the vehicle goes on with it.

Forces are what a path needs, torques are what points them. As long as every torque can be produced, whatever force
comes with it, the attitude is under control; then it only matters how many directions of pure force are left: three,
and the vehicle moves freely; two or one, and they are pointed where force is needed; none, and it cannot follow.
Apart from these stand vehicles built for a level plane, which float upright and push ahead, sideways and turn, or at
least in one direction and turn: that one is pointed by the heading, as a unicycle does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from cube_sim.actuation.subspaces import subspaces
from cube_sim.control.effort import effort_matrix
from cube_sim.spatial import Matrix, Vector

OUT_OF_PLANE = np.array([False, False, True, True, True, False])
"""Heave, roll and pitch among the components of a wrench."""


class Authority(IntEnum):
    """How a vehicle flies; the numbers are stable, recordings store them.

    Attributes:
        HOLONOMIC: all forces and torques: any motion in any attitude.
        PLANE: two directions of pure force, pointed by the attitude.
        LINE: one direction of pure force, pointed by the attitude.
        SAFE: no path can be followed.
        LEVEL: surge, sway and yaw and nothing else: any motion in a level plane.
        UNICYCLE: yaw and one direction of force in a level plane, pointed by the heading.
    """

    HOLONOMIC = 0
    PLANE = 1
    LINE = 2
    SAFE = 3
    LEVEL = 4
    UNICYCLE = 5


@dataclass(frozen=True)
class Capability:
    """What is left, and the projection of demands onto it.

    Attributes:
        authority: how to fly.
        pure_forces: P (3,p) orthonormal directions of force without torque, body axes.
        reason: one line for the log.
        lost_forces: N_f (3, 6 - rank) and
        lost_torques: N_t (3, 6 - rank) of the combinations N_f' F + N_t' M = 0 that hold for all the thrusters can do.
        effort: Q (6,6) [1, 1/m, 1/m^2], of `effort_matrix`.
    """

    authority: Authority
    pure_forces: Matrix
    reason: str
    lost_forces: Matrix
    lost_torques: Matrix
    effort: Matrix

    @property
    def level(self) -> bool:
        """Whether it moves in a level plane only."""
        return self.authority in (Authority.LEVEL, Authority.UNICYCLE)

    @property
    def steers_by_attitude(self) -> bool:
        """Whether force has to be pointed where it is needed."""
        return self.authority in (Authority.PLANE, Authority.LINE, Authority.UNICYCLE)

    def attainable(self, wrench: Vector) -> Vector:
        """The wrench (6,) in the range of A that keeps all torques and changes the force least.

        The combinations that cannot be produced are N_f' F + N_t' M = 0; F moves by
        -N_f (N_f' N_f)^-1 (N_f' F + N_t' M). Where no path can be followed, everything is left to the allocation, which
        comes as close as it can.
        """
        if self.level:
            wrench = np.where(OUT_OF_PLANE, 0.0, wrench)
        if not self.steers_by_attitude:
            return wrench
        missing = self.lost_forces.T @ wrench[:3] + self.lost_torques.T @ wrench[3:]
        step = self.lost_forces @ np.linalg.solve(self.lost_forces.T @ self.lost_forces, missing)
        return np.concatenate([wrench[:3] - step, wrench[3:]])


def capability(A: Matrix) -> Capability:
    """Judge the columns (6,m) of the thrusters that still work."""
    return replace(_judged(A), effort=effort_matrix(A))


def _judged(A: Matrix) -> Capability:
    if A.shape[1] == 0:
        return _capability(Authority.SAFE, np.zeros((3, 0)), np.eye(6), "no thruster is left")
    if not np.any(np.abs(A[OUT_OF_PLANE]) > 1e-9):
        return _level_capability(A)
    space = subspaces(A)
    lost = np.array([combination.coefficients for combination in space.unreachable]).reshape(-1, 6).T
    if space.rank == 6:
        return _capability(Authority.HOLONOMIC, np.eye(3), lost, "all six components of the wrench are there")
    words = "; ".join(str(combination) for combination in space.unreachable)
    p = space.pure_forces.shape[1]
    if p == 0 or not _steerable(lost):
        return _capability(Authority.SAFE, space.pure_forces, lost, f"{words}: the path cannot be followed")
    authority = Authority.PLANE if p == 2 else Authority.LINE
    return _capability(authority, space.pure_forces, lost, f"{words}: the attitude now points the thrust")


def _level_capability(A: Matrix) -> Capability:
    """The same in the plane; to stay upright is the hull's own business."""
    space = subspaces(A[~OUT_OF_PLANE])
    lost = np.zeros((6, len(space.unreachable)))
    for column, combination in zip(lost.T, space.unreachable, strict=True):
        column[~OUT_OF_PLANE] = combination.coefficients
    pure_forces = np.zeros((3, space.pure_forces.shape[1]))
    pure_forces[:2] = space.pure_forces[:2]
    if space.rank == 3:
        return _capability(Authority.LEVEL, pure_forces, lost, "it moves in a level plane")
    words = "; ".join(str(combination) for combination in space.unreachable)
    if space.rank == 2 and _steerable(lost):
        return _capability(Authority.UNICYCLE, pure_forces, lost, f"{words}: the heading now points the thrust")
    return _capability(Authority.SAFE, pure_forces, lost, f"{words}: the path cannot be followed")


def _steerable(lost: Matrix) -> bool:
    """Whether every torque comes with some force: exactly when the lost combinations differ in their force parts."""
    singular = np.linalg.svd(lost[:3], compute_uv=False)
    return len(singular) == lost.shape[1] and bool(singular[-1] > 1e-2)


def _capability(authority: Authority, pure_forces: Matrix, lost: Matrix, reason: str) -> Capability:
    return Capability(authority, pure_forces, reason, lost[:3], lost[3:], np.zeros((6, 6)))
