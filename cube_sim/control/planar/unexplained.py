"""What the planar model does not explain of a vehicle's acceleration, whatever it comes from."""

from __future__ import annotations

from math import exp

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, Vector

UNEXPLAINED = np.dtype([("started", np.bool_), ("nu", np.float64, 3), ("w", np.float64, 3), ("dw", np.float64, 3)])
"""What `UnexplainedAcceleration` remembers: whether there was a tick before, and nu, w and w' as predicted."""


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
        self.time = time
        self.memory: Record = np.zeros(1, UNEXPLAINED)

    def update(self, nu: Vector, explained: Vector, dt: float) -> Vector:
        """w_hat (3,) [m/s^2, m/s^2, rad/s^2] after a tick; zero at the first. See `observe_unexplained`."""
        observe_unexplained(self.time, self.memory, nu, explained, dt)
        return self.memory["w"][0].copy()


@compiled
def observe_unexplained(time, memory, nu, explained, dt):
    """One tick of `UnexplainedAcceleration`.

    Args:
        time: T [s].
        memory: record `UNEXPLAINED`, moved on.
        nu: at the end of the tick, three numbers [m/s, m/s, rad/s].
        explained: a of the model, three numbers, over the tick [m/s^2, m/s^2, rad/s^2].
        dt: its length [s].
    """
    m, q = memory[0], exp(-dt / time)
    for i in range(3):
        if not m.started:
            m.nu[i] = nu[i]
            continue
        m.w[i] += dt * m.dw[i]
        predicted = m.nu[i] + dt * (explained[i] + m.w[i] - 0.5 * dt * m.dw[i])
        error = nu[i] - predicted
        m.nu[i] = predicted + (1.0 - q**3) * error
        m.w[i] += 1.5 * (1.0 - q) ** 2 * (1.0 + q) / dt * error
        m.dw[i] += (1.0 - q) ** 3 / dt**2 * error
    m.started = True
