"""The planar equations of motion of a hull that nothing pushes sideways."""

from __future__ import annotations

from math import atan2, cos, hypot
from typing import NamedTuple


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

    def through(self, current: PlanarCurrent) -> PlanarMotion:
        """The motion through water that moves, of a motion over ground."""
        return PlanarMotion(self.u - current.u, self.v - current.v, self.r)


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

    def d_u(self, motion: PlanarMotion) -> float:
        """Resistance to surge [N]."""
        u, v, r = motion
        return self.D_u * u + self.D_uu * u * abs(u) - self.m_vr * v * r

    def d_v(self, u: float, v: float) -> float:
        """Resistance to sway [N]."""
        return self.D_v * v + self.D_vv * v * abs(v) + self.D_uv * u * v

    def d_v_slopes(self, u: float, v: float) -> tuple[float, float]:
        """Partial derivatives of d_v with respect to u and v [N s/m]."""
        return self.D_uv * v, self.D_v + 2.0 * self.D_vv * abs(v) + self.D_uv * u

    def d_r(self, motion: PlanarMotion) -> float:
        """Resistance to yaw [N m]."""
        u, v, r = motion
        turning = self.K_r * r + self.K_rr * r * abs(r) + self.K_ur * u * r
        return turning + self.K_v * v + self.K_vv * v * abs(v) + self.K_uv * u * v

    def sway_acceleration(self, motion: PlanarMotion) -> float:
        """v' [m/s^2], from the equation without a force."""
        u, v, r = motion
        return -(self.m_ur * u * r + self.d_v(u, v)) / self.m_v

    def loop_gain(self, motion: PlanarMotion, current: PlanarCurrent = STILL_WATER) -> float:
        """How much of a yaw rate turns the course over ground, the rest being side-slip.

        In still water it is 1 - (m_ur / m_v) cos^2 beta. beta' = (u v' - v u') / v_t^2 holds r through v', and beta''
        holds r' in the same way; a law for psi_W has to divide by this. In a current v' = v_r' - r u_c, and the gain is
        (v^2 + (1 - m_ur / m_v) u u_r) / v_t^2: positive where m_ur < m_v and the hull moves ahead both over ground and
        through the water.

        Args:
            motion: over ground.
            current: of the water.
        """
        ratio = self.m_ur / self.m_v
        drift = (1.0 - ratio) * motion.u * current.u / motion.speed**2
        return 1.0 - ratio * cos(motion.side_slip) ** 2 - drift
