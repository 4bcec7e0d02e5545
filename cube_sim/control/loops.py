"""The velocity and attitude loops: desired motion to a wrench, by model feed-forward.

Both loops ask for an acceleration and let the vehicle's own inverse dynamics turn it into a wrench, so that their gains
are time constants [s], the same for every vehicle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import atan2
from typing import Any, NamedTuple

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude
from cube_sim.control.loop_times import FASTEST_TURN
from cube_sim.guidance.law import DesiredMotion
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, State, Vector
from cube_sim.tuples import (
    cross_tuples,
    length,
    minus,
    minus6,
    plus,
    plus6,
    quaternion_times,
    stacked,
    times,
    to_body,
    to_world,
)
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.laws.hull_motion import hull_damping, inverse_dynamics

LOOPS = np.dtype(
    [(name, np.float64) for name in ("velocity_time", "attitude_time", "rate_time", "most_rate")]
    + [("righted", np.float64, 3)]
)
"""Numbers of `MotionLoops`, whose names these are."""
STIFF = 4.0
"""A hull rights itself stiffly about an axis where its righting moment turns it back this many times as hard as the
loops do (a choice)."""


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
    About an axis about which the hull rights itself stiffly, g is that of the desired attitude: what the water turns
    back by itself stays in the loop. To cancel it would leave the loops a small difference of large numbers.
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

    @cached_property
    def record(self) -> Record:
        """The times and the bound, as compiled functions take them: (1,) of `LOOPS`."""
        times = self.velocity_time, self.attitude_time, self.rate_time, self.most_rate
        return np.array([(*times, self.righted)], LOOPS)

    @property
    def righted(self) -> Vector:
        """(3,) 1 about the axes about which the hull rights itself stiffly, 0 about the others."""
        slope = -self.dynamics.restoring_slope(np.array([0.0, 0.0, 1.0]))[3:]
        quick = np.diag(slope) / np.diag(self.dynamics.total_mass)[3:]
        return (quick * self.attitude_time * self.rate_time > STIFF).astype(float)

    def wrench(
        self, state: State, motion: DesiredMotion, attitude: DesiredAttitude, current: Vector
    ) -> tuple[Vector, Reference]:
        """The wrench (6,) [N, N m], body axes, in a steady current (3,) [m/s], world axes, and what it follows."""
        tau, v_ref, w_ref, angle = loop_wrench(
            self.dynamics.record, self.record, *_tuples(state, motion, attitude), tuple(current.tolist())
        )
        return np.array(tau), Reference(np.array(v_ref), np.array(w_ref), angle)


def _tuples(state: State, motion: DesiredMotion, attitude: DesiredAttitude) -> tuple[Any, ...]:
    """The arguments of `loop_wrench` between the records and the current."""
    vectors = state.quaternion, state.velocity, state.rates, *motion, *attitude
    return state.rotation, *(tuple(vector.tolist()) for vector in vectors)


@compiled
def loop_wrench(hull, loops, R, q, v, w, velocity_W, acceleration_W, q_d, w_d_W, current_W):
    """Both loops: desired motion and attitude to a wrench.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        loops: record `LOOPS`.
        R: R_WB (3,3) now.
        q: the same attitude, a 4-tuple.
        v: over ground, a 3-tuple, body axes [m/s].
        w: 3-tuple, body axes [rad/s].
        velocity_W: desired, 3-tuple, world axes [m/s].
        acceleration_W: desired, 3-tuple, world axes [m/s^2].
        q_d: desired attitude, 4-tuple.
        w_d_W: its angular velocity, 3-tuple, world axes [rad/s].
        current_W: 3-tuple, world axes [m/s].

    Returns:
        The wrench (6-tuple), v_ref and w_ref (3-tuples), the angle of the attitude error [rad].
    """
    k = loops[0]
    v_ref = to_body(R, velocity_W)
    pull = plus(to_body(R, acceleration_W), times(1.0 / k.velocity_time, minus(v_ref, v)))
    dv = minus(pull, cross_tuples(w, v))  # a derivative in turning axes

    q_e = quaternion_times((q_d[0], -q_d[1], -q_d[2], -q_d[3]), q)
    short_way = -1.0 if q_e[0] < 0.0 else 1.0
    eta, eps = short_way * q_e[0], times(short_way, q_e[1:])
    w_d = to_body(R, w_d_W)
    w_e = minus(w, w_d)
    back = times(2.0 / k.attitude_time, eps)
    back = times(1.0 / max(1.0, length(back) / k.most_rate), back)
    w_ref = minus(w_d, back)
    turning = plus(times(eta, w_e), cross_tuples(eps, w_e))
    dw_ref = minus(times(-1.0, cross_tuples(w, w_d)), times(1.0 / k.attitude_time, turning))
    dw = plus(dw_ref, times(1.0 / k.rate_time, minus(w_ref, w)))

    nu = stacked(v, w)
    tau = inverse_dynamics(hull, R, nu, stacked(dv, dw), current_W)
    flow = stacked(to_body(R, current_W), (0.0, 0.0, 0.0))
    wanted = hull_damping(hull, minus6(stacked(v_ref, w_ref), flow))
    tau = plus6(tau, minus6(wanted, hull_damping(hull, minus6(nu, flow))))
    turned = to_world(hull[0].hydrostatics[3:], minus((R[2, 0], R[2, 1], R[2, 2]), up_of(q_d)))
    s = k.righted
    tau = plus6(tau, (0.0, 0.0, 0.0, s[0] * turned[0], s[1] * turned[1], s[2] * turned[2]))
    return tau, v_ref, w_ref, 2.0 * atan2(length(eps), eta)


@compiled
def up_of(q):
    """World up in the axes of an attitude (4-tuple), a 3-tuple."""
    w, x, y, z = q
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
