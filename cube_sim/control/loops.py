"""The velocity and attitude loops: desired motion to a wrench, by model feed-forward.

Both loops ask for an acceleration and let the vehicle's own inverse dynamics turn it into a wrench, so that their gains
are time constants [s], the same for every vehicle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude
from cube_sim.control.loop_times import FASTEST_TURN
from cube_sim.guidance.law import DesiredMotion
from cube_sim.spatial import State, Vector, conjugate, cross, multiply
from cube_sim.vehicle.dynamics import Dynamics


class Reference(NamedTuple):
    """What the loops followed at one tick, body axes.

    Attributes:
        velocity: v_ref (3,) [m/s].
        rates: w_ref (3,) [rad/s].
        attitude_error: angle between desired and actual attitude [rad].
    """

    velocity: Vector
    rates: Vector
    attitude_error: float


@dataclass(frozen=True)
class MotionLoops:
    """tau = M nu'_ref + C nu + D nu + g with nu'_ref from proportional errors.

    Velocity: v'_W = a_d + (v_d - v_W) / velocity_time.
    Attitude: q_e = q_d* q, its vector part eps taken with the sign of the scalar part eta, because q and -q are the
    same attitude and the short way round is wanted. The desired rate R'w_d - 2 eps / attitude_time removes a small
    error with that time constant; the rate loop w' = w'_ref + (w_ref - w) / rate_time follows it.
    The desired rate is taken to change only by the vehicle's own turning: w_d' is not fed forward.

    Attributes:
        dynamics: the controller's knowledge of the vehicle.
        velocity_time: [s].
        attitude_time: [s].
        rate_time: [s].
        most_rate: bound on the rate at which an attitude error is turned back [rad/s].
    """

    dynamics: Dynamics
    velocity_time: float
    attitude_time: float
    rate_time: float
    most_rate: float = FASTEST_TURN

    def wrench(
        self, state: State, motion: DesiredMotion, attitude: DesiredAttitude, current: Vector
    ) -> tuple[Vector, Reference]:
        """The wrench (6,) [N, N m], body axes, in a steady current (3,) [m/s], world axes, and what it follows."""
        R, v, w = state.rotation, state.velocity, state.rates
        v_ref = motion.velocity @ R
        pull = motion.acceleration @ R + (v_ref - v) / self.velocity_time
        dv = pull - cross(w, v)  # a derivative in turning axes

        q_e = multiply(conjugate(attitude.quaternion), state.quaternion)
        short_way = -1.0 if q_e[0] < 0.0 else 1.0
        eta, eps = short_way * q_e[0], short_way * q_e[1:]
        w_d = attitude.rates @ R
        w_e = w - w_d
        back = 2.0 * eps / self.attitude_time
        back *= 1.0 / max(1.0, float(np.linalg.norm(back)) / self.most_rate)
        w_ref = w_d - back
        dw_ref = -cross(w, w_d) - (eta * w_e + cross(eps, w_e)) / self.attitude_time
        dw = dw_ref + (w_ref - w) / self.rate_time

        nu, nu_dot = np.concatenate([v, w]), np.concatenate([dv, dw])
        tau = self.dynamics.wrench(R, nu, nu_dot, current)
        flow = np.concatenate([current @ R, np.zeros(3)])
        wanted = np.concatenate([v_ref, w_ref])
        tau += self.dynamics.damping(wanted - flow) - self.dynamics.damping(nu - flow)
        angle = 2.0 * float(np.arctan2(np.linalg.norm(eps), eta))
        return tau, Reference(v_ref, w_ref, angle)
