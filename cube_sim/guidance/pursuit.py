"""The velocity that brings the vehicle to a moving target and keeps it there."""

from __future__ import annotations

from math import sqrt, tanh

import numpy as np

from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.guidance.speed import Parts, SpeedProfile
from cube_sim.guidance.view_record import record_of
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record
from cube_sim.tuples import dot, minus, plus, times, to_world, triple

PURSUIT = np.dtype([("time", np.float64), ("closing_speed", np.float64)])
"""Numbers of `Pursuit`: T_e [s], c [m/s]."""


class Pursuit:
    """The target's own velocity and a pull towards it: v_d = s' T - c tanh(|e| / (c T_e)) e / |e|.

    With e = p - p_d, V = |e|^2 / 2 and v = v_d: V' = -c |e| tanh(|e| / (c T_e)). A small error decays with the time
    constant T_e, a large one is run down at the speed c.

    Args:
        profile: s' of the target at each arc length.
        time: T_e [s].
        closing_speed: c [m/s], beside the target's own.
    """

    def __init__(self, profile: SpeedProfile, time: float, closing_speed: float) -> None:
        self._profile, self._time, self._closing_speed = profile, time, closing_speed

    def motion(self, view: TargetView) -> DesiredMotion:
        """Desired velocity and its derivative, for a vehicle seen from the target."""
        slope = self._profile.at(view.arc_length).slope
        return DesiredMotion(*pursuit_motion(record_of(view), self.record, slope))

    @property
    def speed_parts(self) -> Parts | None:
        """Of its profile; None for one that only Python reads."""
        return getattr(self._profile, "parts", None)

    @property
    def record(self) -> Record:
        """Its numbers, as compiled laws read them: (1,) of `PURSUIT`."""
        return np.array([(self._time, self._closing_speed)], PURSUIT)


@compiled
def pursuit_motion(view, pursuit, slope):
    """Desired velocity (3,) [m/s] and its derivative along the present motion (3,) [m/s^2], world axes.

    Args:
        view: record `cube_sim.guidance.view_record.VIEW`.
        pursuit: record `PURSUIT`.
        slope: of the target's speed along the path [1/s].
    """
    w = view[0]
    k1, k2, ds = w.row[12], w.row[13], w.speed
    e = triple(w.error)
    de = minus(triple(w.velocity), (ds, 0.0, 0.0))
    share, dshare = closing_rate(pursuit, sqrt(dot(e, e)), dot(e, de))
    velocity = minus((ds, 0.0, 0.0), times(share, e))
    acceleration = minus((slope * ds, ds * ds * k1, ds * ds * k2), plus(times(dshare, e), times(share, de)))
    return np.array(to_world(w.frame, velocity)), np.array(to_world(w.frame, acceleration))


@compiled
def closing_rate(pursuit, distance, half_slope):
    """c tanh(|e| / (c T_e)) / |e| [1/s] and its time derivative, smooth through e = 0; half_slope is e e'."""
    p = pursuit[0]
    saturation = distance / (p.closing_speed * p.time)
    if saturation < 1e-4:
        return 1.0 / p.time, 0.0  # off by a third of the square of that
    steepness = tanh(saturation)
    share = p.closing_speed * steepness / distance
    return share, ((1.0 - steepness**2) / p.time - share) * half_slope / distance**2
