"""How fast the loops of the law for all axes are, where a scenario does not say.

Each loop is the quicker, the less delay stands between it and the water. From slow to quick they are: cross-track
error, velocity and attitude, angular rate. Each is several times quicker than the one around it.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LoopTimes:
    """The time in which each loop removes 63 % of its error [s].

    Attributes:
        lateral: the cross-track error, at the speed of the path.
        velocity: the velocity.
        attitude: the attitude.
        rate: the angular rate.
    """

    lateral: float
    velocity: float
    attitude: float
    rate: float

    @staticmethod
    def behind(delay_s: float) -> LoopTimes:
        """The times that leave margins behind a delay.

        A rate loop of T_w = 3 delays crosses over at 1 / (3 delays), where the delay costs 19 degrees of phase and the
        loop around it 17 of the other 90; the gain may rise by more than a factor 4. The velocity loop is as far from
        its limit with the disturbance estimate in it. No loop is quicker than 0.15 s (rate) and 0.5 s: quicker ones
        gain millimetres and pass on the noise of every sensor.

        Args:
            delay_s: mean delay from state to force: lag of the thrusters and 1.5 control periods [s].
        """
        rate = max(0.15, 3.0 * delay_s)
        velocity = max(0.5, 6.0 * delay_s)
        return LoopTimes(lateral=4.0 * velocity, velocity=velocity, attitude=rate / 0.3, rate=rate)
