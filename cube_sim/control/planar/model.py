"""The planar equations of motion of a hull that nothing pushes sideways."""

from __future__ import annotations

from math import atan2, cos, hypot
from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record


class PlanarMotion(NamedTuple):
    """Velocity of the body origin, body axes.

    Attributes:
        u: surge [m/s].
        v: sway, to the left [m/s].
        r: yaw rate, to the left [rad/s].
    """

    u: float
    v: float
    r: float

    @property
    def speed(self) -> float:
        """v_t = sqrt(u^2 + v^2) [m/s]."""
        return hypot(self.u, self.v)

    @property
    def side_slip(self) -> float:
        """beta = atan2(v, u) [rad]: the flow angle psi_W is psi_B + beta."""
        return atan2(self.v, self.u)


class PlanarCurrent(NamedTuple):
    """Velocity of the water over ground, body axes: the same water turns backwards as the hull turns.

    Attributes:
        u: ahead [m/s].
        v: to the left [m/s].
    """

    u: float
    v: float

    @property
    def speed(self) -> float:
        """[m/s]."""
        return hypot(self.u, self.v)


STILL_WATER = PlanarCurrent(0.0, 0.0)


class PlanarModel(NamedTuple):
    """Equation (2) of Lapierre and Soetanto 2007 (Ocean Eng. 34), written with what resists on the left.

        F     = m_u u' + d_u              d_u = D_u u + D_uu u|u| - m_vr v r
        0     = m_v v' + m_ur u r + d_v   d_v = D_v v + D_vv v|v| + D_uv u v
        Gamma = m_r r' + d_r              d_r = K_r r + K_rr r|r| + K_v v + K_vv v|v| + K_uv u v + K_ur u r

    Their vehicle has m_vr = 0; by Kirchhoff's equations it is m_v. In a steady current the equations hold for the
    velocity through the water (Fossen 2011, Handbook of Marine Craft Hydrodynamics and Motion Control, section 8.3).

    Attributes:
        m_u: mass with added mass, surge [kg].
        m_v: the same, sway [kg].
        m_r: moment of inertia with the added one, yaw [kg m^2].
        m_ur: what pushes sideways in a turn [kg].
        m_vr: what pushes ahead in a turn with side-slip [kg].
        D_u: [N s/m].
        D_uu: [N s^2/m^2].
        D_v: [N s/m].
        D_vv: [N s^2/m^2].
        D_uv: [N s^2/m^2].
        K_r: [N m s].
        K_rr: [N m s^2].
        K_v: [N s].
        K_vv: [N s^2/m].
        K_uv: [N s^2/m].
        K_ur: [N s^2].
    """

    m_u: float
    m_v: float
    m_r: float
    m_ur: float
    m_vr: float = 0.0
    D_u: float = 0.0
    D_uu: float = 0.0
    D_v: float = 0.0
    D_vv: float = 0.0
    D_uv: float = 0.0
    K_r: float = 0.0
    K_rr: float = 0.0
    K_v: float = 0.0
    K_vv: float = 0.0
    K_uv: float = 0.0
    K_ur: float = 0.0

    @property
    def record(self) -> Record:
        """The numbers as compiled laws read them."""
        return np.array([self], HULL)

    def d_u(self, motion: PlanarMotion) -> float:
        """Resistance to surge [N]."""
        return surge_resistance.py_func(self, motion)

    def d_v(self, u: float, v: float) -> float:
        """Resistance to sway [N]."""
        return sway_resistance.py_func(self, u, v)

    def d_r(self, motion: PlanarMotion) -> float:
        """Resistance to yaw [N m]."""
        return yaw_resistance.py_func(self, motion)

    def loop_gain(self, motion: PlanarMotion, current: PlanarCurrent = STILL_WATER) -> float:
        """See `loop_gain`."""
        return loop_gain.py_func(self, motion, current)


HULL = np.dtype([(name, np.float64) for name in PlanarModel._fields])
"""`PlanarModel`, whose names these are. The functions below read an element of it, or a `PlanarModel`."""


@compiled
def through(motion, current):
    """The `PlanarMotion` through water that moves with a `PlanarCurrent`, of one over ground."""
    return PlanarMotion(motion.u - current.u, motion.v - current.v, motion.r)


@compiled
def surge_resistance(hull, motion):
    """d_u [N] of a motion through the water."""
    u, v, r = motion
    return hull.D_u * u + hull.D_uu * u * abs(u) - hull.m_vr * v * r


@compiled
def sway_resistance(hull, u, v):
    """d_v [N] at u and v [m/s] through the water."""
    return hull.D_v * v + hull.D_vv * v * abs(v) + hull.D_uv * u * v


@compiled
def sway_resistance_slopes(hull, u, v):
    """Partial derivatives of d_v with respect to u and v [N s/m]."""
    return hull.D_uv * v, hull.D_v + 2.0 * hull.D_vv * abs(v) + hull.D_uv * u


@compiled
def yaw_resistance(hull, motion):
    """d_r [N m] of a motion through the water."""
    u, v, r = motion
    turning = hull.K_r * r + hull.K_rr * r * abs(r) + hull.K_ur * u * r
    return turning + hull.K_v * v + hull.K_vv * v * abs(v) + hull.K_uv * u * v


@compiled
def sway_acceleration(hull, motion):
    """v' [m/s^2] of a motion through the water, from the equation without a force."""
    u, v, r = motion
    return -(hull.m_ur * u * r + sway_resistance(hull, u, v)) / hull.m_v


@compiled
def loop_gain(hull, motion, current):
    """How much of a yaw rate turns the course over ground, the rest being side-slip.

    In still water it is 1 - (m_ur / m_v) cos^2 beta. beta' = (u v' - v u') / v_t^2 holds r through v', and beta''
    holds r' in the same way; a law for psi_W has to divide by this. In a current v' = v_r' - r u_c, and the gain is
    (v^2 + (1 - m_ur / m_v) u u_r) / v_t^2: positive where m_ur < m_v and the hull moves ahead both over ground and
    through the water.

    Args:
        hull: whose inertia it is.
        motion: over ground.
        current: of the water.
    """
    ratio = hull.m_ur / hull.m_v
    drift = (1.0 - ratio) * motion.u * current.u / hypot(motion.u, motion.v) ** 2
    return 1.0 - ratio * cos(atan2(motion.v, motion.u)) ** 2 - drift
