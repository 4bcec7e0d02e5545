"""The planar vehicle of the literature as a plain differential equation, and the law in its printed forms."""

from __future__ import annotations

from math import cos, inf, pi, sin

import numpy as np

from cube_sim.control.planar.approach_angle import ApproachAngle
from cube_sim.control.planar.dynamic import (
    STILL,
    DesiredSpeed,
    DynamicLaw,
    Gains,
    PlanarCommand,
    Water,
    dynamic_command,
    flow_over_ground,
    kinematics,
)
from cube_sim.control.planar.kinematic import kinematic_command
from cube_sim.control.planar.model import STILL_WATER, PlanarCurrent, PlanarModel, PlanarMotion
from cube_sim.control.planar.path_view import PathView, plane_view
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.view_record import record_of

# INFANTE's class: public parameter set, m = 2234.5 kg, Iz = 2000 kg m^2
INFANTE = PlanarModel(
    m_u=2234.5 + 141.9,
    m_v=2234.5 + 1715.4,
    m_r=2000.0 + 1349.0,
    m_ur=2234.5 - 103.4,
    D_uu=35.4,
    D_vv=667.5,
    D_uv=346.76,
    K_rr=310.0,
    K_vv=-433.8,
    K_uv=686.08,
    K_ur=1427.0,
)
SPEED = 1.5
GAINS = Gains(k1=0.5, k2=0.5, k3=1.0, k4=1.0, k5=0.1)
LAW = DynamicLaw(INFANTE, ApproachAngle(pi / 4.0, 0.5), GAINS, least_speed=0.1, target_speed_limit=inf)

RECORD, HULL = LAW.record[0], INFANTE.record[0]


def see(path, x, y, psi_W, s):
    """The planar view of a point from the target at s."""
    point = path.at(s)
    error = (np.array([x, y, 0.0]) - point.position) @ point.rotation
    return PathView(*plane_view(record_of(TargetView(s, inf, 0.0, point, error, np.zeros(3))), psi_W))


def command(motion, view, speed, water=STILL, law=RECORD):
    """Equation (6)."""
    return dynamic_command(law, HULL, motion, view, speed, water)


def corrected(motion, view, water=STILL):
    return command(motion, view, DesiredSpeed(SPEED), water)


def flow_of(motion, current):
    """The motion over ground for which side-slip is evaluated."""
    return flow_over_ground(RECORD, motion, current)


def turned(motion, view, current=STILL_WATER):
    """Equation (5): yaw rate and speed of the target."""
    return kinematic_command(RECORD, HULL, motion, view, current, 0.0)


def printed(resistance=-1.0, square=False, loop_solved=False):
    """The dynamic law as the literature prints it, each of its three differences to be mended by itself.

    Args:
        resistance: sign with which d_u and d_r enter; printed -1, right +1.
        square: whether g_c multiplies s'^2; printed False.
        loop_solved: whether the r' inside beta'' is solved for; not mentioned, so False.
    """

    def law(motion, view):
        k = kinematics(RECORD, HULL, motion, view, DesiredSpeed(SPEED), STILL)
        k1, _, k3, _, k5 = GAINS
        alpha_r = (
            k.dddelta
            - k.ddbeta_without_dr
            - (k1 + k3) * (k.dpsi - k.ddelta)
            - (k5 + k1 * k3) * k.error
            + view.c_c * k.dds
            + view.g_c * (k.ds**2 if square else k.ds)
        )
        if loop_solved:
            alpha_r /= INFANTE.loop_gain(motion)
        force = INFANTE.m_u * k.du + resistance * INFANTE.d_u(motion)
        return PlanarCommand(force, INFANTE.m_r * alpha_r + resistance * INFANTE.d_r(motion), k.ds)

    return law


def in_body(current, psi_B):
    """A current (2,) [m/s] in world axes, in the axes of a hull at this heading."""
    c, s = cos(psi_B), sin(psi_B)
    return PlanarCurrent(c * current[0] + s * current[1], c * current[1] - s * current[0])


def acceleration(motion, current, F, Gamma, model=INFANTE):
    """(u', v', r') over ground of a hull in a current given in body axes."""
    through = PlanarMotion(motion.u - current.u, motion.v - current.v, motion.r)
    return np.array(
        [
            (F - model.d_u(through)) / model.m_u + motion.r * current.v,
            -(model.m_ur * through.u * through.r + model.d_v(through.u, through.v)) / model.m_v - motion.r * current.u,
            (Gamma - model.d_r(through)) / model.m_r,
        ]
    )


def derivative(law, path, q, current=(0.0, 0.0)):
    """d/dt of q = [x, y, psi_B, u, v, r, s] in a current in world axes, and the view at q.

    The law gets the current only where there is one: it may take no more than the motion and the view.
    """
    x, y, psi_B, u, v, r, s = q
    motion, flow = PlanarMotion(u, v, r), in_body(current, psi_B)
    view = see(path, x, y, psi_B + flow_of(motion, flow).side_slip, s)
    command = law(motion, view, Water(flow)) if any(current) else law(motion, view)
    dx, dy = u * cos(psi_B) - v * sin(psi_B), u * sin(psi_B) + v * cos(psi_B)
    return np.array([dx, dy, r, *acceleration(motion, flow, command.F, command.Gamma), command.ds]), view


def step(rate, q, dt):
    """One step of the classical Runge-Kutta method."""
    k1 = rate(q)
    k2 = rate(q + 0.5 * dt * k1)
    k3 = rate(q + 0.5 * dt * k2)
    k4 = rate(q + dt * k3)
    return q + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def fly(law, path, q, duration, dt=0.1, current=(0.0, 0.0)):
    """Rows [t, s1, y1, psi, u - u_d, psi - delta] of a flight from q."""
    rows = []
    q = np.array(q, dtype=float)
    for i in range(round(duration / dt)):
        _, view = derivative(law, path, q, current)
        error = view.psi - LAW.approach.at(view.y1).value
        rows.append([i * dt, view.s1, view.y1, view.psi, q[3] - SPEED, error])
        q = step(lambda q: derivative(law, path, q, current)[0], q, dt)
    return np.array(rows)


def start(path, left, turn=0.0, u=1.0):
    """At rest sideways, `left` m to the left of the path's first point, turned by `turn` from its tangent."""
    point = path.at(0.0)
    T, N1 = point.rotation[:, 0], point.rotation[:, 1]
    x, y, _ = point.position + left * N1
    return [x, y, np.arctan2(T[1], T[0]) + turn, u, 0.0, 0.0, 0.0]
