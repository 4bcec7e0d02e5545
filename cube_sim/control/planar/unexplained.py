"""What the planar model does not explain of a vehicle's acceleration, whatever it comes from."""

from __future__ import annotations

from math import exp

import numpy as np

from cube_sim.spatial import Vector


class UnexplainedAcceleration:
    """An observer of w in nu' = a + w that follows a w that changes steadily without lag; nu = (u, v, r).

    nu, w and w' are predicted, and corrected by the error e of nu with the gains of the fading-memory filter of second
    degree (N. Morrison 1969, Introduction to Sequential Smoothing and Prediction, chapter 13): all three poles lie at
    q = exp(-dt / T), for any dt. So it is stable whatever the tick, and from w to w - w_hat it passes

        s^2 (s + 3 / T) / (s + 1 / T)^3

    in continuous time: nothing of a w that is constant or grows steadily, and 3 (omega T)^2 of one that turns slowly.

    Args:
        time: T [s].
    """

    def __init__(self, time: float) -> None:
        self._time = time
        self._nu: Vector | None = None
        self._w, self._dw = np.zeros(3), np.zeros(3)

    def update(self, nu: Vector, explained: Vector, dt: float) -> Vector:
        """w_hat (3,) [m/s^2, m/s^2, rad/s^2] after a tick; zero at the first.

        Args:
            nu: at the end of the tick (3,) [m/s, m/s, rad/s].
            explained: a (3,) over the tick, of the model.
            dt: its length [s].
        """
        if self._nu is None:
            self._nu = nu
            return self._w
        q = exp(-dt / self._time)
        self._w = self._w + dt * self._dw
        predicted = self._nu + dt * (explained + self._w - 0.5 * dt * self._dw)
        error = nu - predicted
        self._nu = predicted + (1.0 - q**3) * error
        self._w = self._w + 1.5 * (1.0 - q) ** 2 * (1.0 + q) / dt * error
        self._dw = self._dw + (1.0 - q) ** 3 / dt**2 * error
        return self._w
