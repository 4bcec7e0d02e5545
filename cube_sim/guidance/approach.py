"""The velocity that brings the vehicle onto the path and along it."""

from __future__ import annotations

from math import cos, hypot, inf, sin, tanh

import numpy as np

from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.guidance.speed import Parts, SpeedProfile
from cube_sim.guidance.view_record import record_of
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record
from cube_sim.tuples import to_world

APPROACH = np.dtype([(name, np.float64) for name in ("angle", "gain", "stop_time", "closing_speed")])
"""Numbers of `Approach`: psi_a [rad], k_delta [1/m], the stop time [s], infinite for none, c [m/s], 0 for u_d."""


class Approach:
    """The 3-D form of the approach angle delta (Lapierre and Soetanto 2007).

    With rho = |(y1, z1)| and theta = psi_a tanh(k_delta rho) the desired velocity in the path frame is
    u_d(s) [cos theta, -sin theta (y1, z1) / rho]. Far away it points at the path under the angle psi_a; on the path it
    points along it. y1 v_1 + z1 v_2 = -u_d rho sin theta <= 0 everywhere. Towards the end of the path the speed along
    it falls as the remaining length over `stop_time`, and changes sign beyond: the vehicle comes to rest at the end.

    Args:
        profile: u_d at each arc length.
        angle: psi_a [rad], in (0, pi/2).
        gain: k_delta [1/m].
        stop_time: [s]; None to run on along the last tangent.
        closing_limit: bound on the closing speed of a vehicle that can go faster across its path [m/s]; 0: none goes
            faster.
    """

    def __init__(
        self, profile: SpeedProfile, angle: float, gain: float, stop_time: float | None, closing_limit: float = 0.0
    ) -> None:
        self._profile, self._angle, self._gain, self._stop_time = profile, angle, gain, stop_time
        self._closing_limit, self._closing_speed = closing_limit, 0.0

    def no_faster_than(self, time: float) -> Approach:
        """The same, with a small cross-track error removed in no less than a time [s] at the path's highest speed.

        The end of the path is approached no faster, either.
        """
        gain = min(self._gain, 1.0 / (time * self._angle * self._profile.most))
        stop_time = None if self._stop_time is None else max(self._stop_time, time)
        if (gain, stop_time) == (self._gain, self._stop_time):
            return self
        return Approach(self._profile, self._angle, gain, stop_time)

    def at_closing_speed(self, speed: float) -> Approach:
        """The same for a vehicle that affords this speed across its path [m/s]; a small error goes as quickly."""
        closing, most = min(speed, self._closing_limit), self._profile.most
        if closing <= most:
            return self
        faster = Approach(self._profile, self._angle, self._gain * most / closing, self._stop_time, self._closing_limit)
        faster._closing_speed = closing
        return faster

    @property
    def most_speed(self) -> float:
        """The path's highest speed [m/s]."""
        return self._profile.most

    @property
    def least_closing(self) -> float:
        """The share of its closing speed that the path's own speed is: what it may fall to, 1 where it is no faster."""
        return min(1.0, self._profile.most / self._closing_speed) if self._closing_speed > 0.0 else 1.0

    @property
    def lateral_time(self) -> float:
        """In which a small cross-track error shrinks by 63 %, at the path's highest speed [s]."""
        return 1.0 / (self._gain * self._angle * max(self._closing_speed, self._profile.most))

    def motion(self, view: TargetView) -> DesiredMotion:
        """Desired velocity and its derivative, for a vehicle seen from the target."""
        speed, slope = self._profile.at(view.arc_length)
        return DesiredMotion(*approach_motion(record_of(view), self.record, speed, slope))

    @property
    def speed_parts(self) -> Parts | None:
        """Of its profile; None for one that only Python reads."""
        return getattr(self._profile, "parts", None)

    @property
    def record(self) -> Record:
        """Its numbers, as compiled laws read them: (1,) of `APPROACH`."""
        stop_time = inf if self._stop_time is None else self._stop_time
        return np.array([(self._angle, self._gain, stop_time, self._closing_speed)], APPROACH)


@compiled
def approach_motion(view, approach, speed, slope):
    """Desired velocity (3,) [m/s] and its derivative along the present motion (3,) [m/s^2], world axes.

    Args:
        view: record `cube_sim.guidance.view_record.VIEW`.
        approach: record `APPROACH`.
        speed: u_d at the target [m/s].
        slope: du_d/ds there [1/s].
    """
    w, a = view[0], approach[0]
    s1, y1, z1 = w.error
    v_T, v_1, v_2 = w.velocity
    k1, k2, ds = w.row[12], w.row[13], w.speed
    # error kinematics in the moving frame
    ds1 = v_T - ds * (1.0 - k1 * y1 - k2 * z1)
    dy1 = v_1 - k1 * ds * s1
    dz1 = v_2 - k2 * ds * s1

    dspeed = slope * ds
    rho = hypot(y1, z1)
    drho = (y1 * dy1 + z1 * dz1) / rho if rho > 0.0 else 0.0
    saturation = tanh(a.gain * rho)
    theta = a.angle * saturation
    dtheta = a.angle * a.gain * (1.0 - saturation**2) * drho
    along, dalong = speed * cos(theta), dspeed * cos(theta) - speed * sin(theta) * dtheta
    if a.stop_time < inf and (w.remaining - s1) / a.stop_time < along:
        along, dalong = (w.remaining - s1) / a.stop_time, -(ds + ds1) / a.stop_time
    # sin(theta) / rho and its derivative; smooth through rho = 0, where it is psi_a k_delta
    if a.gain * rho < 1e-4:
        share, dshare = a.angle * a.gain, 0.0  # off by the square of that, 1e-8 of itself
    else:
        share = sin(theta) / rho
        dshare = (cos(theta) * dtheta - share * drho) / rho
    across, dacross = (a.closing_speed, 0.0) if a.closing_speed > 0.0 else (speed, dspeed)
    lateral, dlateral = across * share, dacross * share + across * dshare
    side_1, side_2 = -lateral * y1, -lateral * z1
    dside_1, dside_2 = -dlateral * y1 - lateral * dy1, -dlateral * z1 - lateral * dz1

    # the path frame itself turns at s' [0, -k2, k1] about its own axes
    turned = dalong - ds * (k1 * side_1 + k2 * side_2), dside_1 + ds * k1 * along, dside_2 + ds * k2 * along
    velocity, acceleration = to_world(w.frame, (along, side_1, side_2)), to_world(w.frame, turned)
    return np.array(velocity), np.array(acceleration)
