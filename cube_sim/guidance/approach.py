"""The velocity that brings the vehicle onto the path and along it."""

from __future__ import annotations

from math import cos, hypot, sin, tanh

import numpy as np

from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.guidance.speed import SpeedProfile


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
    """

    def __init__(self, profile: SpeedProfile, angle: float, gain: float, stop_time: float | None) -> None:
        self._profile, self._angle, self._gain, self._stop_time = profile, angle, gain, stop_time

    def no_faster_than(self, time: float) -> Approach:
        """The same, with a small cross-track error removed in no less than a time [s] at the path's highest speed."""
        gain = 1.0 / (time * self._angle * self._profile.most)
        return self if self._gain <= gain else Approach(self._profile, self._angle, gain, self._stop_time)

    def motion(self, view: TargetView) -> DesiredMotion:
        """Desired velocity and its derivative, for a vehicle seen from the target."""
        s1, y1, z1 = view.error.tolist()
        v_T, v_1, v_2 = view.velocity.tolist()
        k1, k2 = view.point.curvature
        ds = view.speed
        # error kinematics in the moving frame
        ds1 = v_T - ds * (1.0 - k1 * y1 - k2 * z1)
        dy1 = v_1 - k1 * ds * s1
        dz1 = v_2 - k2 * ds * s1

        speed, slope = self._profile.at(view.arc_length)
        dspeed = slope * ds
        rho = hypot(y1, z1)
        drho = (y1 * dy1 + z1 * dz1) / rho if rho > 0.0 else 0.0
        saturation = tanh(self._gain * rho)
        theta = self._angle * saturation
        dtheta = self._angle * self._gain * (1.0 - saturation**2) * drho
        along, dalong = speed * cos(theta), dspeed * cos(theta) - speed * sin(theta) * dtheta
        if self._stop_time is not None and (view.remaining - s1) / self._stop_time < along:
            along, dalong = (view.remaining - s1) / self._stop_time, -(ds + ds1) / self._stop_time
        share, dshare = self._lateral_share(rho, theta, drho, dtheta)
        lateral, dlateral = speed * share, dspeed * share + speed * dshare
        side_1, side_2 = -lateral * y1, -lateral * z1
        dside_1, dside_2 = -dlateral * y1 - lateral * dy1, -dlateral * z1 - lateral * dz1

        # the path frame itself turns at s' [0, -k2, k1] about its own axes
        R = view.point.rotation
        acceleration = np.array(
            [
                dalong - ds * (k1 * side_1 + k2 * side_2),
                dside_1 + ds * k1 * along,
                dside_2 + ds * k2 * along,
            ]
        )
        return DesiredMotion(R @ np.array([along, side_1, side_2]), R @ acceleration)

    def _lateral_share(self, rho: float, theta: float, drho: float, dtheta: float) -> tuple[float, float]:
        """sin(theta) / rho and its time derivative; smooth through rho = 0, where it is psi_a k_delta."""
        if self._gain * rho < 1e-4:
            return self._angle * self._gain, 0.0  # off by the square of that, 1e-8 of itself
        share = sin(theta) / rho
        return share, (cos(theta) * dtheta - share * drho) / rho
