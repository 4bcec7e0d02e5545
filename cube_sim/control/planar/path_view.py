"""A vehicle near a level path, as plane geometry sees it."""

from __future__ import annotations

from math import atan2, hypot, tau
from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled


class PathView(NamedTuple):
    """Equations (3) and (4): the vehicle in the path frame {F} of the virtual target.

    Attributes:
        s1: how far the vehicle is ahead along the tangent [m].
        y1: how far it is to the left [m].
        psi: psi_W - psi_F, the flow angle against the tangent [rad].
        c_c: curvature of the path, positive to the left [1/m].
        g_c: dc_c/ds [1/m^2].
    """

    s1: float
    y1: float
    psi: float
    c_c: float
    g_c: float


@compiled
def wrap(angle):
    """The same angle in [-pi, pi] [rad]."""
    return angle - tau * np.rint(angle / tau)


@compiled
def heading(R):
    """psi_B [rad] of a nearly level vehicle, from R_WB (3,3)."""
    return atan2(R[1, 0], R[0, 0])


@compiled
def plane_view(view, psi_W):
    """The `PathView` of a vehicle.

    The left normal is (-T_y, T_x) of a level tangent; the normals of a parallel-transport frame keep a constant angle
    to it, so curvature and its rate are projected onto it in the same way.

    Args:
        view: record of `cube_sim.guidance.view_record.VIEW`, from the virtual target on a level path.
        psi_W: flow angle [rad], from world x.
    """
    frame, error, row = view[0].frame, view[0].error, view[0].row
    T_x, T_y = frame[0, 0], frame[1, 0]
    size = hypot(T_x, T_y)
    left_1 = (T_x * frame[1, 1] - T_y * frame[0, 1]) / size
    left_2 = (T_x * frame[1, 2] - T_y * frame[0, 2]) / size
    return PathView(
        error[0],
        error[1] * left_1 + error[2] * left_2,
        wrap(psi_W - atan2(T_y, T_x)),
        row[12] * left_1 + row[13] * left_2,
        row[14] * left_1 + row[15] * left_2,
    )
