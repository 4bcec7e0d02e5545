"""The dynamic law (6): which force ahead and which torque bring the vehicle onto the path."""

from __future__ import annotations

from math import cos, hypot, sin
from typing import NamedTuple

import numpy as np

from cube_sim.control.planar.approach_angle import ApproachAngle, approach_angle
from cube_sim.control.planar.model import (
    STILL_WATER,
    PlanarCurrent,
    PlanarModel,
    PlanarMotion,
    loop_gain,
    surge_resistance,
    sway_acceleration,
    sway_resistance_slopes,
    through,
    yaw_resistance,
)
from cube_sim.control.planar.path_view import wrap
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record


class Gains(NamedTuple):
    """The gains of proposition 2.

    Attributes:
        k1: [1/s].
        k2: [1/s].
        k3: [1/s].
        k4: [1/s].
        k5: [1/s^2].
    """

    k1: float
    k2: float
    k3: float
    k4: float
    k5: float


class DesiredSpeed(NamedTuple):
    """u_d and its time derivatives [m/s, m/s^2, m/s^3]."""

    value: float
    rate: float = 0.0
    bend: float = 0.0


class Water(NamedTuple):
    """What the law reckons with beside its model of the hull in still water.

    Attributes:
        current: velocity of the water, body axes.
        du: what of u' the model does not explain [m/s^2].
        dv: the same of v' [m/s^2].
        dr: the same of r' [rad/s^2].
    """

    current: PlanarCurrent = STILL_WATER
    du: float = 0.0
    dv: float = 0.0
    dr: float = 0.0


STILL = Water()
"""The water of the published law."""


class PlanarCommand(NamedTuple):
    """What the law asks for.

    Attributes:
        F: force ahead [N].
        Gamma: torque to the left [N m].
        ds: s', speed of the virtual target [m/s].
    """

    F: float
    Gamma: float
    ds: float


class Kinematics(NamedTuple):
    """Everything the law differentiates; a leading d is d/dt, dd the second derivative.

    Attributes:
        error: psi - delta, the short way round [rad].
        du: u' under the surge loop [m/s^2].
        ds: [m/s].
        dds: [m/s^2].
        dpsi: [rad/s].
        ddelta: [rad/s].
        dddelta: second derivative of delta [rad/s^2].
        ddbeta_without_dr: second derivative of beta if r were constant [rad/s^2].
    """

    error: float
    du: float
    ds: float
    dds: float
    dpsi: float
    ddelta: float
    dddelta: float
    ddbeta_without_dr: float


class DynamicLaw(NamedTuple):
    """Proposition 2 of Lapierre and Soetanto 2007, corrected, with its algebraic loops solved.

        F     = m_u (u_d' - k4 (u - u_d)) + d_u
        Gamma = m_r alpha_r + d_r
        s'    = v_t cos psi + k2 s1
        alpha_r = delta'' - beta'' - (k1 + k3)(psi' - delta') - (k5 + k1 k3)(psi - delta) + c_c s'' + g_c s'^2

    Printed are -d_u, -d_r and g_c s'. With (2) as written the resistances have to be added, and c_c' s' is g_c s'^2.
    Then psi - delta obeys e'' + (k1 + k3) e' + (k5 + k1 k3) e = 0. beta'' depends on r' = alpha_r through v''; the law
    is affine in it and is solved for it.

    In a current u, v and beta are taken over ground: then (1), (3) and (4) hold as they stand, psi_W is the course, and
    s1, y1, psi - delta and u - u_d obey the same equations as in still water. Only (2) is about the velocity through
    the water (u_r, v_r) = (u - u_c, v - v_c). As the hull turns, a steady current turns in body axes, u_c' = r v_c and
    v_c' = -r u_c, so

        F  = m_u (u' - r v_c) + d_u(u_r, v_r, r)            Gamma = m_r alpha_r + d_r(u_r, v_r, r)
        v' = -(m_ur u_r r + d_v(u_r, v_r)) / m_v - r u_c    v'' likewise

    Both are affine in r and r' again and solved for them (`loop_gain`). The hull holds the crab angle at
    which v_r is that of a turn in still water. This is the case of a current that is known of P. Encarnacao, A. Pascoal
    and M. Arcak 2000 (Path following for marine vehicles in the presence of unknown currents, IFAC SYROCO), for the law
    of 2007; `CurrentFilter` estimates one that is not.

    At low surge speed side-slip means nothing. The law is then evaluated as if u and u_r were `least_speed` at least,
    until its force has brought the vehicle to speed.

    Attributes:
        model: the vehicle.
        approach: delta.
        gains: k1 to k5.
        least_speed: [m/s], below u_d.
        target_speed_limit: bound on |s'| [m/s]; beyond it the target runs steadily.
    """

    model: PlanarModel
    approach: ApproachAngle
    gains: Gains
    least_speed: float
    target_speed_limit: float

    @property
    def record(self) -> Record:
        """The numbers beside the model's, as compiled laws read them."""
        return np.array([(*self.approach, *self.gains, self.least_speed, self.target_speed_limit)], LAW)


LAW = np.dtype(
    [(name, np.float64) for name in (*ApproachAngle._fields, *Gains._fields, "least_speed", "target_speed_limit")]
)
"""`DynamicLaw` without its model, its approach and gains name by name."""


@compiled
def flow_over_ground(law, motion, current):
    """The `PlanarMotion` over ground for which side-slip is evaluated; arguments as in `kinematics`."""
    return PlanarMotion(max(motion.u, law.least_speed + max(current.u, 0.0)), motion.v, motion.r)


@compiled
def kinematics(law, hull, motion, path, speed, water):
    """What `dynamic_command` combines.

    Args:
        law: element of `LAW`.
        hull: element of `cube_sim.control.planar.model.HULL`.
        motion: `PlanarMotion` over ground.
        path: `PathView`, seen from the virtual target.
        speed: `DesiredSpeed`.
        water: `Water`.

    Returns:
        `Kinematics`.
    """
    s1, y1, psi, c_c, g_c = path
    current, k2, k4 = water.current, law.k2, law.k4
    # surge over ground under its own loop, sway by (2)
    du = speed.rate - k4 * (motion.u - speed.value)
    ddu = speed.bend - k4 * (du - speed.rate)
    flow = flow_over_ground(law, motion, current)
    u, v, r = flow
    v_t = hypot(u, v)
    relative = through(flow, current)
    du_through, dv_through = du - r * current.v, sway_acceleration(hull, relative) + water.dv
    dv = dv_through - r * current.u
    d_v_u, d_v_v = sway_resistance_slopes(hull, relative.u, relative.v)
    ddv_through = -(hull.m_ur * du_through * r + d_v_u * du_through + d_v_v * dv_through) / hull.m_v
    ddv_without_dr = ddv_through - r * r * current.v
    dv_t = (u * du + v * dv) / v_t
    dbeta = (u * dv - v * du) / v_t**2
    ddbeta_without_dr = (u * ddv_without_dr - v * ddu) / v_t**2 - 2.0 * dbeta * dv_t / v_t
    # (3) and (4)
    wanted = v_t * cos(psi) + k2 * s1
    ds = min(max(wanted, -law.target_speed_limit), law.target_speed_limit)
    ds1 = v_t * cos(psi) - ds * (1.0 - c_c * y1)
    dy1 = v_t * sin(psi) - c_c * ds * s1
    dpsi = r + dbeta - c_c * ds
    dds = dv_t * cos(psi) - v_t * sin(psi) * dpsi + k2 * ds1 if ds == wanted else 0.0
    ddy1 = dv_t * sin(psi) + v_t * cos(psi) * dpsi - (g_c * ds**2 + c_c * dds) * s1 - c_c * ds * ds1
    delta = approach_angle(law, y1)
    dddelta = delta.bend * dy1**2 + delta.slope * ddy1
    return Kinematics(wrap(psi - delta.value), du, ds, dds, dpsi, delta.slope * dy1, dddelta, ddbeta_without_dr)


@compiled
def dynamic_command(law, hull, motion, path, speed, water):
    """The `PlanarCommand` of `DynamicLaw`; arguments as in `kinematics`."""
    k1, k3, k5 = law.k1, law.k3, law.k5
    flow = flow_over_ground(law, motion, water.current)
    k = kinematics(law, hull, motion, path, speed, water)
    alpha_r = (
        k.dddelta
        - k.ddbeta_without_dr
        - (k1 + k3) * (k.dpsi - k.ddelta)
        - (k5 + k1 * k3) * k.error
        + path.c_c * k.dds
        + path.g_c * k.ds**2
    ) / loop_gain(hull, flow, water.current)
    relative = through(motion, water.current)
    du_through = k.du - motion.r * water.current.v
    F = hull.m_u * (du_through - water.du) + surge_resistance(hull, relative)
    return PlanarCommand(F, hull.m_r * (alpha_r - water.dr) + yaw_resistance(hull, relative), k.ds)
