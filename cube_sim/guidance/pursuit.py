"""The velocity that brings the vehicle to a moving target and keeps it there."""

from __future__ import annotations

from math import sqrt, tanh

from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.guidance.speed import SpeedProfile


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
        T, N1, N2 = view.point.rotation.T
        k1, k2 = view.point.curvature
        ds = view.speed
        dds = self._profile.at(view.arc_length).slope * ds
        e = view.point.rotation @ view.error
        de = view.point.rotation @ view.velocity - ds * T
        share, dshare = self._closing_rate(sqrt(float(e @ e)), float(e @ de))
        return DesiredMotion(
            velocity=ds * T - share * e,
            acceleration=dds * T + ds**2 * (k1 * N1 + k2 * N2) - dshare * e - share * de,
        )

    def _closing_rate(self, distance: float, half_slope: float) -> tuple[float, float]:
        """c tanh(|e| / (c T_e)) / |e| [1/s] and its time derivative, smooth through e = 0; half_slope is e e'."""
        saturation = distance / (self._closing_speed * self._time)
        if saturation < 1e-4:
            return 1.0 / self._time, 0.0  # off by a third of the square of that
        steepness = tanh(saturation)
        share = self._closing_speed * steepness / distance
        return share, ((1.0 - steepness**2) / self._time - share) * half_slope / distance**2
