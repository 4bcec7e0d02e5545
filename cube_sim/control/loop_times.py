"""How fast the loops of the law for all axes are, where a scenario does not say.

Each loop is the quicker, the less delay stands between it and the water. From slow to quick they are: cross-track
error, velocity and attitude, angular rate. Each is several times quicker than the one around it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from cube_sim.spatial import Matrix, Vector

FASTEST_TURN = 1.0
"""Bound on the rate at which any vehicle is asked to turn [rad/s]."""
COMMON_ERROR = 0.5
"""An attitude error that the torque still turns back without saturating [rad]."""
POINTING_ERROR = 0.8
"""The same for a vehicle whose attitude points its thrust, and so turns at every error of its path [rad]."""
POINTING_SLOWER, HEADING_SLOWER = 1.5, 2.4
"""How many times slower the attitude is turned back where it points the thrust; where the heading alone does, in a
level plane. The force that is pointed answers the very turn that points it, as a hull slips where it turns to, and as
what thrusters make more than they are believed to turns with the hull: that takes 10 to 20 degrees of the phase."""
USUAL_PERIOD_S = 0.02
"""The control period of a scenario that does not say."""
NO_TORQUE = 1e-6
"""Share of the largest torque that counts as none."""


@dataclass(frozen=True)
class LoopTimes:
    """The time in which each loop removes 63 % of its error [s].

    Attributes:
        lateral: the cross-track error, at the speed of the path.
        velocity: the velocity.
        attitude: the attitude.
        rate: the angular rate.
        pointing: the attitude, where it points the thrust.
        turn: not a time: how fast the vehicle is asked to turn at most [rad/s].
    """

    lateral: float
    velocity: float
    attitude: float
    rate: float
    pointing: float
    turn: float = FASTEST_TURN

    @staticmethod
    def behind(delay_s: float, turning: float = inf, pointing: bool = False, level: bool = False) -> LoopTimes:
        """The times that leave margins behind a delay, with the torque there is.

        A rate loop of T_w = 3 delays crosses over at 1 / (3 delays), where the delay costs 19 degrees of phase and the
        loop around it 17 of the other 90; the gain may rise by more than a factor 3. The velocity loop is as far from
        its limit with the disturbance estimate in it. No loop is quicker than 0.15 s (rate) and 0.5 s: quicker ones
        gain millimetres and pass on the noise of every sensor. An attitude error of half a radian asks for
        0.5 / T_a^2 rad/s^2, and that is not more than the torque gives; where the attitude points the thrust, one of
        0.8 rad.

        Args:
            delay_s: mean delay from state to force: lag of the thrusters and 1.5 control periods [s].
            turning: angular acceleration that the thrusters' torque gives [rad/s^2].
            pointing: whether the attitude of the whole vehicle points the thrust.
            level: whether it is one for a level plane.
        """
        attitude = max(0.5, 10.0 * delay_s, sqrt((POINTING_ERROR if pointing else COMMON_ERROR) / turning))
        velocity = max(0.5, 6.0 * delay_s)
        return LoopTimes(
            lateral=4.0 * velocity,
            velocity=velocity,
            attitude=attitude,
            rate=0.3 * attitude,
            pointing=(HEADING_SLOWER if level else POINTING_SLOWER) * attitude,
            turn=min(FASTEST_TURN, turning * attitude),
        )


def mean_delay(lag_s: Vector, control_period_s: float) -> float:
    """From the state to the force of thrusters that lag by these times (m,), on average [s]."""
    return float(np.max(lag_s, initial=0.0)) + 1.5 * control_period_s


def angular_acceleration(A: Matrix, limits: Matrix, inertia: Matrix, righting: Vector) -> float:
    """What the thrusters' torque gives about the axis with least of it [rad/s^2]; infinite where there is none.

    Axes about which the hull's righting moment has twice the thrusters' torque do not count: the water holds these.

    Args:
        A: (6,m).
        limits: (m,4) [N].
        inertia: (3,3) [kg m^2], added inertia included.
        righting: r (3,) [N m], body axes.
    """
    ends = A[3:, :, None] * limits[None, :, [0, 3]]
    torque = np.minimum(ends.max(axis=2).sum(axis=1), -ends.min(axis=2).sum(axis=1))
    held = np.array([righting[2], righting[2], 0.0]) / 2.0
    counts = torque > np.maximum(held, NO_TORQUE * torque.max(initial=0.0))
    return float(np.min(torque[counts] / np.diag(inertia)[counts], initial=inf))
