"""A vehicle near a level path, as plane geometry sees it."""

from __future__ import annotations

from math import atan2, hypot, tau
from typing import NamedTuple

from cube_sim.guidance.law import TargetView
from cube_sim.spatial import Matrix


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


def plane_view(view: TargetView, psi_W: float) -> PathView:
    """The planar part of a target view.

    The left normal is (-T_y, T_x) of a level tangent; the normals of a parallel-transport frame keep a constant angle
    to it, so curvature and its rate are projected onto it in the same way.

    Args:
        view: seen from the virtual target on a level path.
        psi_W: flow angle [rad], from world x.
    """
    T, N1, N2 = view.point.rotation.T
    left_1, left_2 = _left(T, N1), _left(T, N2)
    (k1, k2), (dk1, dk2) = view.point.curvature, view.point.curvature_rate
    s1, y1, z1 = view.error.tolist()
    return PathView(
        s1=s1,
        y1=y1 * left_1 + z1 * left_2,
        psi=wrap(psi_W - atan2(T[1], T[0])),
        c_c=k1 * left_1 + k2 * left_2,
        g_c=dk1 * left_1 + dk2 * left_2,
    )


def wrap(angle: float) -> float:
    """The same angle in [-pi, pi] [rad]."""
    return angle - tau * round(angle / tau)


def heading(rotation: Matrix) -> float:
    """psi_B [rad] of a nearly level vehicle, from R_WB."""
    return atan2(rotation[1, 0], rotation[0, 0])


def _left(T: Matrix, N: Matrix) -> float:
    return float(T[0] * N[1] - T[1] * N[0]) / hypot(T[0], T[1])
