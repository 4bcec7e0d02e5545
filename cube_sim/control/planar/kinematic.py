"""The kinematic law (5): which yaw rate brings the vehicle onto the path, at the speed it has."""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from cube_sim.control.planar.approach_angle import ApproachAngle
from cube_sim.control.planar.model import STILL_WATER, PlanarCurrent, PlanarModel, PlanarMotion
from cube_sim.control.planar.path_view import PathView, wrap


class KinematicCommand(NamedTuple):
    """What the law asks for.

    Attributes:
        r: yaw rate [rad/s].
        ds: s', speed of the virtual target [m/s].
    """

    r: float
    ds: float


class KinematicLaw(NamedTuple):
    """Proposition 1 of Lapierre and Soetanto 2007, with its algebraic loop solved.

        r  = delta' - beta' - k1 (psi - delta) + c_c s'
        s' = v_t cos psi + k2 s1

    so that (psi - delta)' = -k1 (psi - delta), and, once psi = delta, (s1^2 + y1^2)'/2 = -k2 s1^2 + v_t y1 sin delta.
    beta' depends on r through v'; the law is affine in r and is solved for it. psi - delta is taken the short way
    round. In a current beta is the side-slip over ground, so psi_W is the course; the hull crabs.

    Attributes:
        model: whose sway follows the turning.
        approach: delta.
        k1: [1/s].
        k2: [1/s].
    """

    model: PlanarModel
    approach: ApproachAngle
    k1: float
    k2: float

    def command(
        self, motion: PlanarMotion, path: PathView, current: PlanarCurrent = STILL_WATER, dv_unexplained: float = 0.0
    ) -> KinematicCommand:
        """The yaw rate for a surge speed that is kept; the yaw rate in `motion` is not used.

        Args:
            motion: over ground.
            path: seen from the virtual target.
            current: of the water.
            dv_unexplained: what of v' the model does not say [m/s^2].
        """
        u, v, _ = motion
        v_t = motion.speed
        s1, y1, psi, c_c, _ = path
        ds = v_t * cos(psi) + self.k2 * s1
        dy1 = v_t * sin(psi) - c_c * ds * s1
        delta = self.approach.at(y1)
        ddelta = delta.slope * dy1
        dv_without_r = self.model.sway_acceleration(PlanarMotion(u, v, 0.0).through(current)) + dv_unexplained
        dbeta_without_r = u * dv_without_r / v_t**2
        r = ddelta - dbeta_without_r - self.k1 * wrap(psi - delta.value) + c_c * ds
        return KinematicCommand(r / self.model.loop_gain(motion, current), ds)
