"""Staying in a place beside thrusters that are stuck: what to try, and when to let go.

What is done is never to end worse than all other thrusters off, as the equations of motion tell where the hull would be
carried then. So the way taken is the best by the model, and it is left once it has led farther than that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.left_alone import carried_m
from cube_sim.control.pace import ForceBudget
from cube_sim.control.resting import Rest
from cube_sim.spatial import State, Vector, quaternion_from_rotation
from cube_sim.vehicle.dynamics import Dynamics

LOOKED_AHEAD_S = 60
"""How far ahead it is worked out where a hull left alone is carried; longer goes on as far each minute (a choice)."""
ROOM_M = 2.0
"""By how much more a hull may be carried, on its way to where it is held, than if it were left alone (a choice)."""
TURNED = 0.2
"""Share of a righting moment, or of the torque that is stuck, below which a missing torque turns a hull little."""
TRIED_M = 2.0
"""How far an attempt may carry the hull, and that room, before the next one begins; each time twice as far (a choice).
"""
PAUSE_S = 10.0
"""For how long a hull is left alone before the next attempt, each time twice as long (a choice)."""


@dataclass(frozen=True)
class Stuck:
    """What there is to know beside what is stuck.

    Attributes:
        rest: where the hull is held at rest, or least is missing for it.
        held_m: how far it is carried there in the time that is looked ahead [m]; infinite where it turns away.
        alone_m: how far in each second (n,) [m], if all thrusters that are not stuck are off.
        points: whether the attitude points the thrust.
    """

    rest: Rest
    held_m: float
    alone_m: Vector
    points: bool

    @staticmethod
    def of(budget: ForceBudget, hull: Dynamics, rest: Rest, state: State, current: Vector, points: bool) -> Stuck:
        """Beside a budget, for a hull in a state, at rest in an attitude, in a current (3,) [m/s], world axes."""
        nu = np.concatenate([state.velocity, state.rates])
        alone = carried_m(hull.record, budget.held, state.rotation, nu, current, LOOKED_AHEAD_S)
        held = 0.0 if rest.held else carried_off_m(hull, budget, rest, LOOKED_AHEAD_S)
        return Stuck(rest, held, alone, points)


@dataclass
class Holding:
    """An attempt to stay in a place, or a while in which the thrusters that work are off.

    Attributes:
        attitude: to take there; None for the one it would take if nothing was stuck.
        alone_m: the largest distance (n,) [m] that it is carried in each of as many seconds from the start if all
            thrusters that are not stuck are off.
        begun_m: how far it is off its place at the start [m].
        count: of the attempts before.
        left_alone: whether all thrusters that are not stuck are off.
        carried_m: how much farther off its place it is than at the start [m].
        time: since the start [s].
    """

    attitude: FixedAttitude | None
    alone_m: Vector
    begun_m: float
    count: int = 0
    left_alone: bool = False
    carried_m: float = 0.0
    time: float = 0.0

    @staticmethod
    def first(stuck: Stuck, begun_m: float) -> Holding:
        """How to begin, so far off the place [m]: left alone where that is known to be best."""
        held, alone = stuck.held_m, stuck.alone_m
        if not stuck.points and _stays(alone) and held + ROOM_M >= alone[-1]:
            return Holding(None, alone, begun_m, left_alone=True)
        return Holding._attempt(stuck, begun_m, 0)

    @staticmethod
    def _attempt(stuck: Stuck, begun_m: float, count: int) -> Holding:
        """Try to hold it where it rests, or nearly does; every other time as if nothing was stuck.

        A hull that points its thrust tries that first: it is often held so while it turns round and round, which no
        balance at rest knows of.
        """
        alone = stuck.alone_m
        better = stuck.held_m + ROOM_M < alone[-1]
        if better and (count % 2 == 0) != stuck.points:
            return Holding(FixedAttitude(quaternion_from_rotation(stuck.rest.attitude)), alone, begun_m, count)
        return Holding(None, alone, begun_m, count)

    def watch(self, off_m: float, dt: float) -> None:
        """See how far it is off its place [m] by now."""
        self.time += dt
        self.carried_m = off_m - self.begun_m - ROOM_M

    @property
    def over(self) -> bool:
        """Whether something else is to be done: what was expected of it has not come, or it has had its time."""
        if self._worse_than_nothing:
            return True
        if self.left_alone:
            return not _stays(self.alone_m) and self.time > PAUSE_S * 2.0**self.count
        return self.carried_m > TRIED_M * 2.0**self.count

    @property
    def _worse_than_nothing(self) -> bool:
        """Whether it has been carried farther than it was to be if it was left alone."""
        whole, part = divmod(self.time, float(len(self.alone_m)))
        rounds = whole * self.alone_m[-1] if whole else 0.0  # where it cannot be told it is infinite
        return bool(self.carried_m > rounds + self.alone_m[int(part)])

    def next(self, stuck: Stuck, off_m: float) -> Holding:
        """What to do instead: the next attempt, or none for a while after one that was worse than that."""
        if not self.left_alone and self._worse_than_nothing:
            return Holding(None, stuck.alone_m, off_m, self.count, left_alone=True)
        return Holding._attempt(stuck, off_m, self.count + 1)


def _stays(alone_m: Vector) -> bool:
    """Whether a hull left alone is carried about, but not away."""
    return bool(np.isfinite(alone_m[-1]) and alone_m[-1] - alone_m[len(alone_m) // 2] < ROOM_M)


def carried_off_m(hull: Dynamics, budget: ForceBudget, rest: Rest, seconds: int) -> float:
    """How far what is missing of the force carries a hull [m] in an attitude; infinite where it turns away from it."""
    torque = float(np.linalg.norm(rest.missing[3:]))
    if torque > TURNED * max(float(np.linalg.norm(hull.righting_moment)), float(np.linalg.norm(budget.held[3:]))):
        return np.inf
    push = -rest.missing[:3]
    size = float(np.linalg.norm(push))
    if size == 0.0:
        return 0.0
    slow, fast = 0.0, 1.0
    along = push / size
    while _drag_along(hull, fast, along) < size and fast < 100.0:
        fast *= 2.0
    for _ in range(20):
        middle = 0.5 * (slow + fast)
        slow, fast = (middle, fast) if _drag_along(hull, middle, along) < size else (slow, middle)
    return fast * seconds


def _drag_along(hull: Dynamics, speed_m_s: float, along: Vector) -> float:
    return float(hull.damping(np.concatenate([speed_m_s * along, np.zeros(3)]))[:3] @ along)
