"""Finding thruster faults from what was commanded and what came back.

The force each thruster should give is known: its command through the motor's delay and lag and the characteristic. The
force it gives is measured (motor telemetry: speed and current). A sliding window of the two, x and y, is held against
what is believed of the thruster:

    whole  y = x
    weak   y = e x
    dead   y = 0
    stuck  y = c

The belief stays as long as it fits. When it no longer fits, the window has to say which of the others the thruster is.

A weak and a stuck thruster look alike while x stands still, and nearly so while it creeps: y = e x fits any constant.
So a thruster is believed weak only when its force was seen to move with x. It is believed stuck only when y = e x does
not fit. In between it is doubtful, and gets another command for a moment (`Probes`). Dead thrusters are probed too:
otherwise nothing would show that they recover.
"""

from __future__ import annotations

import numpy as np

from cube_sim.control.probing import Probes
from cube_sim.spatial import Vector
from cube_sim.wrench.health import Health


class Diagnosis:
    """A running judgement of m thrusters.

    Args:
        window_s: length of the window [s]: the time a fault has to last to be believed.
        threshold_N: forces and differences below this say nothing [N].
        dt: control period [s].
        probe_N: (m,) what silent thrusters are asked for [N], well beyond the threshold.

    Attributes:
        health: what is believed.
        doubtful: (m,) bool, which thrusters do something else than believed that can be read in more than one way.
    """

    WHOLE = 0.9
    """Efficiencies above this count as whole; a characteristic is not known better."""
    DEAD = 0.1
    """Efficiencies below this count as dead."""

    def __init__(self, window_s: float, threshold_N: float, dt: float, probe_N: Vector) -> None:
        self._threshold = threshold_N
        n, m = max(2, round(window_s / dt)), len(probe_N)
        self._size = np.sqrt(n) * threshold_N
        self._expected, self._measured = np.zeros((n, m)), np.zeros((n, m))
        self._filled, self._row = 0, 0
        self._probes = Probes(probe_N, dt)
        self.health = Health.whole(m)
        self.doubtful = np.zeros(m, dtype=bool)

    def probed(self, force: Vector) -> Vector:
        """The forces (m,) [N] to ask for at this tick, a probe among them when one is due."""
        return self._probes.with_probe(force, self.health, self.doubtful)

    def update(self, expected: Vector, measured: Vector) -> Health:
        """Judge after one more tick.

        Args:
            expected: (m,) forces [N] whole thrusters would give now.
            measured: (m,) forces [N] they give.
        """
        n = len(self._expected)
        self._expected[self._row], self._measured[self._row] = expected, measured
        self._row = (self._row + 1) % n
        self._filled = min(self._filled + 1, n)
        if self._filled < n:
            return self.health
        health = self.health
        believed = np.where(np.isnan(health.stuck), health.efficiency * self._expected, health.stuck)
        contradicted = np.linalg.norm(self._measured - believed, axis=0) > self._size
        self.doubtful = np.zeros(len(expected), dtype=bool)
        for i in np.flatnonzero(contradicted):
            self._judge(int(i))
        return self.health

    def _judge(self, i: int) -> None:
        """Believe something else of a thruster that does not do what is believed of it, if its window says what."""
        x, y, size = self._expected[:, i], self._measured[:, i], self._size
        energy = float(x @ x)
        share = min(1.0, max(0.0, float(x @ y) / energy)) if energy > 0.0 else 0.0
        misfit = float(np.linalg.norm(y - share * x))
        swing = float(np.linalg.norm(y - y.mean()))
        proportional = energy > size**2 and misfit <= 0.5 * size
        if proportional and share >= self.DEAD and not self._holds_for_newer_half(i, share):
            return  # the fault came amid the window, which mixes two truths
        if np.all(np.abs(y) <= self._threshold):
            # So little that it does not matter whether it is weak or stuck at that; or a stuck one that has let go.
            self._believe(i, self._efficiency(share) if proportional else 0.0)
        elif proportional:
            efficiency = self._efficiency(share)
            if swing > 0.5 * size and misfit <= 0.5 * swing:
                self._believe(i, efficiency)
            elif efficiency != self.health.efficiency[i]:
                self.doubtful[i] = True
        elif swing < 0.2 * size and np.all(np.abs(y) > self._threshold):
            self._believe(i, 0.0, float(y.mean()))

    def _holds_for_newer_half(self, i: int, share: float) -> bool:
        """Whether y = share x, found over the window, holds for its newer half too."""
        n = len(self._expected)
        newer = (self._row + np.arange(n // 2, n)) % n
        x, y = self._expected[newer, i], self._measured[newer, i]
        tolerance = max(0.2 * share * float(np.linalg.norm(x)), 0.1 * self._size)
        return bool(np.linalg.norm(y - share * x) <= tolerance)

    def _efficiency(self, share: float) -> float:
        return 0.0 if share < self.DEAD else 1.0 if share > self.WHOLE else round(share, 2)

    def _believe(self, i: int, efficiency: float, stuck: float = np.nan) -> None:
        if efficiency != self.health.efficiency[i] or not np.isnan(stuck) or not np.isnan(self.health.stuck[i]):
            self.health = self.health.with_thruster(i, efficiency, stuck)
