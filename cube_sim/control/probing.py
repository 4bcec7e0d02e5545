"""Asking a silent or doubtful thruster for a force of its own, to learn from what it gives.

A thruster believed dead is commanded nothing, so nothing it does can show that it is whole again. One under a constant
command gives the same force whether it is weak or stuck. Now and then such a thruster gets another command for a
moment. The allocation does not count on what comes of it: a thruster that is dead or stuck adds nothing, and one that
answers is known within a few control periods. Then its probe ends.
"""

from __future__ import annotations

import numpy as np

from cube_sim.spatial import Vector
from cube_sim.wrench.health import Health


class Probes:
    """One probe at a time, each thruster at most once a period.

    Args:
        force: (m,) [N] what a silent thruster is asked for. A doubtful one is asked for it too, or for nothing when
            that is farther from its command.
        dt: control period [s].
        period_s: between two probes of one thruster, and from its loss to the first [s].
        length_s: the most a probe takes [s].
    """

    def __init__(self, force: Vector, dt: float, period_s: float = 5.0, length_s: float = 0.3) -> None:
        m = len(force)
        self._force = force
        self._period, self._length = max(1, round(period_s / dt)), max(1, round(length_s / dt))
        self._wait = np.zeros(m, dtype=int)
        self._was_responsive = np.ones(m, dtype=bool)
        self._thruster, self._left, self._asked = -1, 0, 0.0
        self._before = self._health = Health.whole(m)
        # Nothing to count down and nobody silent: nothing to do while the health stays the same object.
        self._at_rest = False

    def with_probe(self, force: Vector, health: Health, doubtful: np.ndarray) -> Vector:
        """The forces (m,) [N] to ask for at this tick in place of `force`, a probe among them when one is due.

        To be called at every tick.

        Args:
            force: (m,) [N] what the thrusters are to be commanded, as if they were whole.
            health: what is believed of them.
            doubtful: (m,) bool, which ones need another command to be judged.
        """
        if self._at_rest and health is self._health and not doubtful.any():
            return force
        silent = (health.efficiency == 0.0) & np.isnan(health.stuck)
        self._wait = np.maximum(0, self._wait - 1)
        self._wait[silent & self._was_responsive] = self._period
        self._was_responsive = health.responsive
        if self._left > 0 and not self._unchanged(health):
            self._left = 0
        if self._left == 0:
            self._start(np.flatnonzero((silent | doubtful) & (self._wait == 0)), force, health)
        self._health = health
        self._at_rest = self._left == 0 and not silent.any() and not self._wait.any()
        if self._left == 0:
            return force
        self._left -= 1
        probed = force.copy()
        probed[self._thruster] = self._asked
        return probed

    def _start(self, due: np.ndarray, force: Vector, health: Health) -> None:
        if due.size == 0:
            return
        self._thruster = i = int(due[0])
        self._asked = 0.0 if abs(force[i]) > 0.5 * abs(self._force[i]) else float(self._force[i])
        self._left, self._before = self._length, health
        self._wait[i] = self._period

    def _unchanged(self, health: Health) -> bool:
        """Whether no more is known of the probed thruster than when its probe began."""
        i, before = self._thruster, self._before
        same_hold = health.stuck[i] == before.stuck[i] or bool(np.isnan(health.stuck[i]) and np.isnan(before.stuck[i]))
        return bool(health.efficiency[i] == before.efficiency[i]) and same_hold
