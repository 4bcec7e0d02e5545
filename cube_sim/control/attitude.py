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

    def attitude(self, view: TargetView, force_W: Vector, dt: float) -> DesiredAttitude:
        """The attitude wanted.

        Args:
            view: the vehicle seen from the virtual target.
            force_W: force (3,) [N] demanded at the tick before, world axes.
            dt: time to the next call [s].
        """
        ...


class FixedAttitude:
    """One attitude in the world, q_WD (4,) wxyz."""

    def __init__(self, quaternion: Vector) -> None:
        self._desired = DesiredAttitude(quaternion, np.zeros(3))

    def attitude(self, view: TargetView, force_W: Vector, dt: float) -> DesiredAttitude:
        """The same at every tick."""
        return self._desired


class AlongPath:
    """Body x along the path's tangent T, body y level, no roll.

    Level means nothing where the path is vertical, so it is not read off the tangent but steered to: the side axis is
    carried along without spin (parallel transport) and turned about T at the rate

        w spin_level + (h^2 / levelling_time) phi,

    phi the angle to level, h the sine of the angle between T and the vertical, spin_level the rate that keeps a level
    side level, w = 1 away from the vertical and 0 on it. On ordinary paths phi stays zero; through a vertical stretch
    the heading is kept; after a half loop the vehicle rolls out of its upside-down attitude instead of jumping.

    Args:
        levelling_time: [s].
    """

    STEEP = 0.1
    """Value of h below which spin_level, which grows as 1 / h, begins to be faded out."""

    def __init__(self, levelling_time: float = 2.0) -> None:
        self._levelling_time = levelling_time
        self._side: Vector | None = None

    def attitude(self, view: TargetView, force_W: Vector, dt: float) -> DesiredAttitude:
        """The attitude at the target's point of the path, and how it turns as the target runs on."""
        T, N1, N2 = view.point.rotation.T
        k1, k2 = view.point.curvature
        dT = view.speed * (k1 * N1 + k2 * N2)
        level = cross(UP, T)
        h = float(np.linalg.norm(level))
        if self._side is None:
            self._side = N1 if h < 1e-9 else level / h
        side = self._side - T * (self._side @ T)
        side /= np.linalg.norm(side)
        top = cross(T, side)

        spin = 0.0
        if h > 1e-9:
            level /= h
            phi = float(np.arctan2(top @ level, side @ level))
            fade = min(1.0, h / self.STEEP) ** 3
            spin_level = float(cross(T, level) @ cross(UP, dT)) / h
            spin = fade * spin_level + h**2 / self._levelling_time * phi
        rates = cross(T, dT) + spin * T
        turned = side + dt * cross(rates, side)
        self._side = turned / np.linalg.norm(turned)
        return DesiredAttitude(quaternion_from_rotation(np.column_stack([T, side, top])), rates)
