"""Finding thruster faults from what was commanded and what came back.

The force each motor should give is known: its command through its lag and characteristic. The force it gives is
measured (motor telemetry: speed and current). Over a sliding window the two are compared by least squares through the
origin, y = e x: a whole thruster has e = 1, a weak one the same shape with e < 1, a dead one e = 0. A stuck one fits no
line: its y stays where it is while x moves.
"""

from __future__ import annotations

import numpy as np

from cube_sim.allocation.health import Health
from cube_sim.spatial import Vector


class Diagnosis:
    """A running judgement of m thrusters.

    Args:
        lag_s: (m,) time constants of the motors [s].
        window_s: length of the window [s]: the time a fault has to last to be believed.
        threshold_N: forces and differences below this say nothing [N].
    """

    WHOLE = 0.9
    """Efficiencies above this count as whole; a characteristic is not known better."""
    DEAD = 0.1
    """Efficiencies below this count as dead."""

    def __init__(self, lag_s: Vector, window_s: float, threshold_N: float, dt: float) -> None:
        self._decay = np.exp(-dt / lag_s)
        self._threshold = threshold_N
        n, m = max(2, round(window_s / dt)), len(lag_s)
        self._expected, self._measured = np.zeros((n, m)), np.zeros((n, m))
        self._filled, self._row = 0, 0
        self.activation = np.zeros(m)
        self.health = Health.whole(m)

    def advance(self, commands: Vector) -> None:
        """Carry the motors' lag over one tick of constant commands (m,)."""
        self.activation = commands + (self.activation - commands) * self._decay

    def update(self, expected: Vector, measured: Vector) -> Health:
        """Judge after one more tick.

        Args:
            expected: (m,) forces [N] whole motors would give now.
            measured: (m,) forces [N] they give.
        """
        n = len(self._expected)
        self._expected[self._row], self._measured[self._row] = expected, measured
        self._row = (self._row + 1) % n
        self._filled = min(self._filled + 1, n)
        if self._filled < n:
            return self.health
        for i in range(len(expected)):
            self._judge(i)
        return self.health

    def _judge(self, i: int) -> None:
        x, y = self._expected[:, i], self._measured[:, i]
        size = np.sqrt(len(x)) * self._threshold
        energy = float(x @ x)
        fitted = float(x @ y) / energy if energy > 0.0 else 1.0
        misfit = float(np.linalg.norm(y - fitted * x))
        moved, stayed = float(np.linalg.norm(x - x.mean())), float(np.linalg.norm(y - y.mean()))
        off = float(np.linalg.norm(y - x))
        believed = self.health
        if off <= size:
            if energy > size**2 and not believed.obedient[i]:
                self.health = believed.with_thruster(i)  # it answers as it should again
            return
        if np.all(np.abs(y) > self._threshold) and stayed < 0.2 * size and (moved > size or misfit > size):
            self.health = believed.with_thruster(i, 0.0, float(y.mean()))
        elif energy > size**2 and misfit < 0.5 * size:
            efficiency = 0.0 if fitted < self.DEAD else 1.0 if fitted > self.WHOLE else round(min(fitted, 1.0), 2)
            if abs(efficiency - believed.efficiency[i]) > 0.05 or not np.isnan(believed.stuck[i]):
                self.health = believed.with_thruster(i, efficiency)
