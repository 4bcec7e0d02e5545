"""The attitude of least effort: the vehicle turns to where its thrusters have least to do."""

from __future__ import annotations

from math import atan2

import numpy as np

from cube_sim.control.attitude_mode import DESIRED, DesiredAttitude, Situation
from cube_sim.control.damped_inverse import damped_inverse
from cube_sim.control.turning_on import turn_on
from cube_sim.guidance.view_record import record_of
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, rotation_about
from cube_sim.tuples import (
    cross_tuples,
    dot,
    length,
    minus,
    plus,
    plus6,
    put_matrix,
    stacked,
    times,
    to_body,
    to_world,
    triple,
)
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.laws.hull_motion import steady_wrench, steady_wrench_slope, turning_slope

MAX_RATE = 0.5
"""Bound on the turning of the desired attitude [rad/s]."""
SOFTNESS_N = 1.0
"""Efforts of this size and less hardly turn the vehicle."""
DAMPING = 0.2
"""Share of the effort that is added to its curvature."""

EFFORT = np.dtype(
    [
        ("time", np.float64),
        ("root", np.float64, (6, 6)),
        ("righting", np.float64, 3),
        ("lift", np.float64),
        ("lift_root", np.float64),
    ]
)
"""Numbers of `FreeAttitude`: T [s]; a matrix whose transpose times itself is Q; the righting moment r [N m] at a right
angle; its size; the root of what a torque costs, the mean over all directions [1/m]."""
MEMORY = np.dtype(
    [
        ("rotation", np.float64, (3, 3)),
        ("force", np.float64, 3),
        ("velocity", np.float64, 3),
        ("started", np.bool_),
    ]
)
"""The desired attitude R_WD; the averages of the force demanded [N] and of the velocity over ground [m/s], world axes;
whether there are any yet."""


class FreeAttitude:
    """Damped Gauss-Newton descent of the effort E = w' Q w over attitudes, Q = (A A')^+, at the pace of T.

    E is the least |f|^2 [N^2] of thruster forces that make the wrench w; dead zones and limits are ignored. w(R) is the
    wrench the motion needs in the attitude R, at the present velocity over ground and in the present current. It has
    three parts: the drag of the hull turned that way, the torque that holds it against its righting moment, and the
    rest of the force demanded now, which stands still in the world. Forces and velocities are averaged over T before.

    By torques alone a hull upside down rests as well as an upright one. So its potential energy |r| - r z counts like a
    torque of that size; r is the righting moment at a right angle, z = R' e_z. Beyond a right angle the righting moment
    falls again, and the hull could hang there. It is therefore turned back at the pace 1 / T.

    Args:
        dynamics: the controller's knowledge of the hull.
        time: T [s], several times that of the attitude loop.
    """

    def __init__(self, dynamics: Dynamics, time: float) -> None:
        self.dynamics = dynamics
        self._effort: Matrix | None = None
        self.parameters: Record = np.zeros(1, EFFORT)
        self.parameters["time"], self.parameters["righting"] = time, dynamics.righting_moment
        self.parameters["lift"] = np.linalg.norm(dynamics.righting_moment)
        self.memory: Record = np.zeros(1, MEMORY)

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """The desired attitude, from the vehicle's own at the first call on, and how it turns."""
        self.reckon_with(situation.effort)
        desired = np.zeros(1, DESIRED)
        least_effort(
            self.dynamics.record,
            self.parameters,
            self.memory,
            desired,
            record_of(situation.view),
            situation.rotation,
            triple(situation.force),
            triple(situation.current),
            dt,
        )
        return DesiredAttitude(*desired[0])

    def upright(self, rotation: Matrix) -> Matrix:
        """The attitude (3,3) nearest to another in which the hull's righting moment is at rest."""
        righting, vertical = self.dynamics.righting_moment, np.array([0.0, 0.0, 1.0])
        if not righting.any():
            return rotation
        up = rotation @ righting / np.linalg.norm(righting)
        normal = np.cross(up, vertical)
        angle = atan2(np.linalg.norm(normal), up @ vertical)
        if not normal.any():
            normal = np.array([1.0, 0.0, 0.0])  # upright, or any way round
        return rotation_about(normal / np.linalg.norm(normal), angle) @ rotation

    def reckon_with(self, effort: Matrix) -> None:
        """Take Q (6,6) of the thrusters that work from now on."""
        if effort is self._effort:
            return
        self._effort = effort
        sizes, axes = np.linalg.eigh(effort)
        self.parameters["root"] = (axes * np.sqrt(np.maximum(sizes, 0.0))).T  # root' root = Q
        self.parameters["lift_root"] = np.sqrt(np.trace(effort[3:, 3:]) / 3.0)


@compiled
def least_effort(hull, parameters, memory, answer, view, R_now, force_W, current_W, dt):
    """One tick of the law.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        parameters: record `EFFORT`.
        memory: record `MEMORY`, moved on.
        answer: record of `cube_sim.control.attitude_mode.DESIRED`, filled.
        view: record of `cube_sim.guidance.view_record.VIEW`.
        R_now: R_WB (3,3) of the hull, where the desired attitude begins.
        force_W: demanded at the tick before, a 3-tuple [N], world axes.
        current_W: estimate, a 3-tuple [m/s], world axes.
        dt: [s].
    """
    p, m = parameters[0], memory[0]
    velocity_W = to_world(view[0].frame, triple(view[0].velocity))
    if not m.started:
        m.started = True
        put_matrix(m.rotation, R_now)
        for i in range(3):
            m.force[i], m.velocity[i] = force_W[i], velocity_W[i]
    share = min(1.0, dt / p.time)
    for i in range(3):
        m.force[i] += share * (force_W[i] - m.force[i])
        m.velocity[i] += share * (velocity_W[i] - m.velocity[i])
    R, flow_W = m.rotation, minus(triple(m.velocity), current_W)
    steady = steady_wrench(hull, to_body(R_now, flow_W), (R_now[2, 0], R_now[2, 1], R_now[2, 2]))
    rest_W = minus(triple(m.force), to_world(R_now, steady[:3]))
    z = (R[2, 0], R[2, 1], R[2, 2])
    rates = plus(_descent(hull, p, to_body(R, flow_W), to_body(R, rest_W), z), _righting_rate(p, z))
    turn_on(R, answer, rates, MAX_RATE, dt)


@compiled
def _descent(hull, p, flow, rest, z):
    """Turning rate -(J' J + d I)^-1 J' y / T, a 3-tuple [rad/s]; all in body axes.

    y (7,) [N] is what is squared: E, and the share of the potential energy. J is its derivative by a small rotation.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        p: of `EFFORT`.
        flow: velocity relative to the water, a 3-tuple [m/s].
        rest: the force demanded beside drag, weight and lift, a 3-tuple [N].
        z: world up.
    """
    wrench = plus6(steady_wrench(hull, flow, z), stacked(rest, (0.0, 0.0, 0.0)))
    by_velocity = steady_wrench_slope(hull, np.array(stacked(flow, (0.0, 0.0, 0.0))), np.zeros(6))
    by_turning = turning_slope(hull, by_velocity, flow, rest, z)
    y, J, squared = np.zeros(7), np.zeros((7, 3)), 0.0
    for k in range(6):
        for i in range(6):
            y[k] += p.root[k, i] * wrench[i]
            for j in range(3):
                J[k, j] += p.root[k, i] * by_turning[i, j]
    righting = triple(p.righting)
    sinking = cross_tuples(z, righting)  # of -r z, as z' = z x theta
    y[6] = p.lift_root * (p.lift - dot(righting, z))
    for j in range(3):
        J[6, j] = p.lift_root * sinking[j]
    for k in range(7):
        squared += y[k] * y[k]
    step = damped_inverse(J, y, 7, DAMPING * squared + SOFTNESS_N * SOFTNESS_N)
    return times(-1.0 / p.time, step)


@compiled
def _righting_rate(p, z):
    """The rate that turns a hull back which lies beyond a right angle, a 3-tuple [rad/s], body axes."""
    if not p.lift > 0.0:
        return (0.0, 0.0, 0.0)
    upright = times(1.0 / p.lift, triple(p.righting))
    if dot(upright, z) >= 0.0:
        return (0.0, 0.0, 0.0)
    normal = cross_tuples(upright, z)
    sine = length(normal)
    if not sine > 1e-6:
        normal = cross_tuples(upright, (upright[2], upright[0] + 1.0, upright[1]))  # any one will do
        return times(1.0 / (length(normal) * p.time), normal)
    return times((1.0 - sine) / (sine * p.time), normal)
