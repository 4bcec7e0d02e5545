"""The attitude whose nose follows the path."""

from __future__ import annotations

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.control.levelling import UP, levelling_spin
from cube_sim.spatial import Vector, cross, quaternion_from_rotation


class AlongPath:
    """Body x along the path's tangent T, body y level, no roll.

    Level means nothing where the path is vertical, so the law steers to it instead of reading it off the tangent. The
    side axis is carried along without spin (parallel transport) and turned about T by `levelling_spin`. On ordinary
    paths it stays level. Through a vertical stretch the heading is kept. After a half loop the vehicle rolls out of its
    upside-down attitude instead of jumping.

    Args:
        levelling_time: [s].
    """

    def __init__(self, levelling_time: float = 2.0) -> None:
        self._levelling_time = levelling_time
        self._side: Vector | None = None

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The attitude at the target's point of the path, and how it turns as the target runs on."""
        view = situation.view
        T, N1, _ = view.point.rotation.T
        dT = cross(view.turning, T)
        if self._side is None:
            level = cross(UP, T)
            h = float(np.linalg.norm(level))
            self._side = N1 if h < 1e-9 else level / h
        side = self._side - T * (self._side @ T)
        side /= np.linalg.norm(side)
        top = cross(T, side)

        rates = view.turning + levelling_spin(T, dT, side, self._levelling_time) * T
        turned = side + dt * cross(rates, side)
        self._side = turned / np.linalg.norm(turned)
        return DesiredAttitude(quaternion_from_rotation(np.column_stack([T, side, top])), rates)
