"""Asking a silent or doubtful thruster for a force of its own, to learn from what it gives.

A thruster believed dead is commanded nothing, so nothing it does can show that it is whole again. One under a constant
command gives the same force whether it is weak or stuck. Now and then such a thruster gets another command for a
moment. The allocation does not count on what comes of it: a thruster that is dead or stuck adds nothing, and one that
answers is known within a few control periods. Then its probe ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Vector
from cube_sim.tuples import put
from cube_sim.wrench.health import Health


class ProbeMemory(NamedTuple):
    """What probes there are, and how far they have come.

    Attributes:
        force: (m,) [N] what a silent thruster is asked for.
        period: between two probes of one thruster [ticks].
        length: the most a probe takes [ticks].
        wait: (m,) until a thruster may be probed [ticks]; moved on, like all that follow.
        was_responsive: (m,) bool, at the tick before.
        running: (2,) the thruster that is probed, and for how many ticks more.
        asked: (1,) what it is asked for [N].
        efficiency: (m,) believed when that probe began.
        stuck: (m,) likewise [N].
    """

    force: Vector
    period: int
    length: int
    wait: NDArray[np.int64]
    was_responsive: NDArray[np.bool_]
    running: NDArray[np.int64]
    asked: Vector
    efficiency: Vector
    stuck: Vector


class Probes:
    """One probe at a time, each thruster at most once a period.

    Args:
        force: (m,) [N] what a silent thruster is asked for. A doubtful one is asked for it too, or for nothing when
            that is farther from its command.
        dt: control period [s].
        period_s: between two probes of one thruster, and from its loss to the first [s].
        length_s: the most a probe takes [s].

    Attributes:
        memory: of `with_probe`.
    """

    def __init__(self, force: Vector, dt: float, period_s: float = 5.0, length_s: float = 0.3) -> None:
        m = len(force)
        self.memory = ProbeMemory(
            force=np.array(force, dtype=np.float64),
            period=max(1, round(period_s / dt)),
            length=max(1, round(length_s / dt)),
            wait=np.zeros(m, np.int64),
            was_responsive=np.ones(m, np.bool_),
            running=np.array([-1, 0]),
            asked=np.zeros(1),
            efficiency=np.ones(m),
            stuck=np.full(m, np.nan),
        )

    def with_probe(self, force: Vector, health: Health, doubtful: np.ndarray) -> Vector:
        """The forces (m,) [N] to ask for at this tick in place of `force`, a probe among them when one is due.

        To be called at every tick.

        Args:
            force: (m,) [N] what the thrusters are to be commanded, as if they were whole.
            health: what is believed of them.
            doubtful: (m,) bool, which ones need another command to be judged.
        """
        probed = force.copy()
        put_probe(self.memory, *health, doubtful, probed)
        return probed


@compiled
def put_probe(memory, efficiency, stuck, doubtful, force):
    """One tick of `Probes`.

    Args:
        memory: `ProbeMemory`, moved on.
        efficiency: (m,) believed share.
        stuck: (m,) force [N] believed to be held; NaN where none is.
        doubtful: (m,) bool.
        force: (m,) [N] to be asked for, changed.
    """
    p, due = memory, -1
    for i in range(len(force)):
        silent, responsive = efficiency[i] == 0.0 and np.isnan(stuck[i]), efficiency[i] > 0.0 and np.isnan(stuck[i])
        p.wait[i] = max(0, p.wait[i] - 1)
        if silent and p.was_responsive[i]:
            p.wait[i] = p.period
        p.was_responsive[i] = responsive
        if due < 0 and (silent or doubtful[i]) and p.wait[i] == 0:
            due = i
    if p.running[1] > 0:
        # No more may be known of the probed thruster than when its probe began.
        i = p.running[0]
        held = stuck[i] == p.stuck[i] or (np.isnan(stuck[i]) and np.isnan(p.stuck[i]))
        if efficiency[i] != p.efficiency[i] or not held:
            p.running[1] = 0
    if p.running[1] == 0 and due >= 0:
        p.running[0], p.running[1], p.wait[due] = due, p.length, p.period
        p.asked[0] = 0.0 if abs(force[due]) > 0.5 * abs(p.force[due]) else p.force[due]
        put(p.efficiency, efficiency)
        put(p.stuck, stuck)
    if p.running[1] > 0:
        p.running[1] -= 1
        force[p.running[0]] = p.asked[0]
