"""Which attitude the vehicle is to take."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from cube_sim.guidance.virtual_target import TargetView
from cube_sim.spatial import Vector, cross, quaternion_from_rotation

UP = np.array([0.0, 0.0, 1.0])


class DesiredAttitude(NamedTuple):
    """What the attitude loop is to follow.

    Attributes:
        quaternion: q_WD (4,) wxyz.
        rates: its angular velocity (3,) [rad/s], world axes.
    """

    quaternion: Vector
    rates: Vector


class AttitudeMode(Protocol):
    """A rule that gives the desired attitude at each tick."""

    def attitude(self, view: TargetView) -> DesiredAttitude:
        """The attitude wanted for a vehicle seen from the virtual target."""
        ...


class FixedAttitude:
    """One attitude in the world, q_WD (4,) wxyz."""

    def __init__(self, quaternion: Vector) -> None:
        self._desired = DesiredAttitude(quaternion, np.zeros(3))

    def attitude(self, view: TargetView) -> DesiredAttitude:
        """The same at every tick."""
        return self._desired


class AlongPath:
    """Body x along the path's tangent, body y level: no roll, whatever the slope.

    Where the path is vertical, level says nothing about heading. Within `STEEP` of the vertical the last side axis is
    kept, turned with the tangent only as far as it must, so the vehicle neither spins nor jumps on its way through.
    """

    STEEP = 0.05  # sine of the angle between tangent and vertical below which heading has no meaning

    def __init__(self) -> None:
        self._side: Vector | None = None

    def attitude(self, view: TargetView) -> DesiredAttitude:
        """The tangent's attitude at the target, turning as the target runs."""
        T, N1, N2 = view.point.rotation.T
        k1, k2 = view.point.curvature
        dT = view.speed * (k1 * N1 + k2 * N2)
        horizontal = cross(UP, T)
        size = float(np.linalg.norm(horizontal))
        if size > self.STEEP:
            side = horizontal / size
            dhorizontal = cross(UP, dT) / size
        else:
            last = N1 if self._side is None else self._side
            side = last - T * (last @ T)
            size = float(np.linalg.norm(side))
            side /= size
            dhorizontal = -T * (last @ dT) / size
        self._side = side
        dside = dhorizontal - side * (side @ dhorizontal)
        top = cross(T, side)
        # the angular velocity of [T, side, top] from the derivatives of its columns
        rates = T * (top @ dside) - side * (top @ dT) + top * (side @ dT)
        return DesiredAttitude(quaternion_from_rotation(np.column_stack([T, side, top])), rates)
