"""The kinematic law (5): which yaw rate brings the vehicle onto the path, at the speed it has."""

from __future__ import annotations

from math import cos, hypot, sin
from typing import NamedTuple

from cube_sim.control.planar.approach_angle import approach_angle
from cube_sim.control.planar.model import PlanarMotion, loop_gain, sway_acceleration, through
from cube_sim.control.planar.path_view import wrap
from cube_sim.native.compiled import compiled


class KinematicCommand(NamedTuple):
    """What the law asks for.

    Attributes:
        r: yaw rate [rad/s].
        ds: s', speed of the virtual target [m/s].
    """

    r: float
    ds: float


@compiled
def kinematic_command(law, hull, motion, path, current, dv_unexplained):
    """Proposition 1 of Lapierre and Soetanto 2007, with its algebraic loop solved.

        r  = delta' - beta' - k1 (psi - delta) + c_c s'
        s' = v_t cos psi + k2 s1

    so that (psi - delta)' = -k1 (psi - delta), and, once psi = delta, (s1^2 + y1^2)'/2 = -k2 s1^2 + v_t y1 sin delta.
    beta' depends on r through v'; the law is affine in r and is solved for it. psi - delta is taken the short way
    round. In a current beta is the side-slip over ground, so psi_W is the course; the hull crabs. Surge is taken to be
    kept; the yaw rate in `motion` is not used.

    Args:
        law: element of `cube_sim.control.planar.dynamic.LAW`, of which k1, k2 and delta are read.
        hull: element of `cube_sim.control.planar.model.HULL`, whose sway follows the turning.
        motion: `PlanarMotion` over ground.
        path: `PathView`, seen from the virtual target.
        current: `PlanarCurrent` of the water.
        dv_unexplained: what of v' the model does not say [m/s^2].

    Returns:
        `KinematicCommand`.
    """
    u, v, _ = motion
    v_t = hypot(u, v)
    s1, y1, psi, c_c, _ = path
    ds = v_t * cos(psi) + law.k2 * s1
    dy1 = v_t * sin(psi) - c_c * ds * s1
    delta = approach_angle(law, y1)
    ddelta = delta.slope * dy1
    dv_without_r = sway_acceleration(hull, through(PlanarMotion(u, v, 0.0), current)) + dv_unexplained
    dbeta_without_r = u * dv_without_r / v_t**2
    r = ddelta - dbeta_without_r - law.k1 * wrap(psi - delta.value) + c_c * ds
    return KinematicCommand(r / loop_gain(hull, motion, current), ds)
