"""How far a hull will leave its path after a fault: its law flown ahead, on the equations of motion that it knows.

A copy of the law is asked, tick by tick, for the wrench it would ask for. The thrusters that are left make of it what
they can, behind their lag, and the hull moves by the model, in the current that is believed. So turning to another
attitude, pointing the thrust and being turned round are all in it, whatever the path does meanwhile. It is a forecast
and no bound: dead zones are not in it, nor probes, nor what the model does not know.

What the observer of the disturbance has learned by then is the push of the fault, or something that stays: both are
flown. `foreseen` is where the one leads, `with_margin_m` is reckoned from the farther of both.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from cube_sim.control.holding import ROOM_M
from cube_sim.control.left_alone import carried_m, gone_on
from cube_sim.control.left_thrusters import LeftThrusters, make_wrench, spin_up
from cube_sim.control.path_follower import PathFollower
from cube_sim.native.compiled import compiled
from cube_sim.spatial import State, Vector
from cube_sim.tuples import minus6, quaternion_from_matrix, sextuple, triple
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics

AHEAD_S = 30.0
"""So far it is flown ahead (a choice)."""
TICK_S = 0.04
"""Ticks shorter than this are flown several at once: none of the loops is quicker than four of them."""
STEP_S = 0.02
"""Of the integration, at most."""
BACK, BACK_S = 0.3, 8.0
"""It has come back once it is at this share of the farthest, so long after (a choice)."""
LEAST_TOLD_M = 0.001
"""No forecast is smaller."""
LEAST_M = 0.01
"""Nearer than this, dead zones and what is not known of the water decide (a choice)."""
MARGIN = 2.0
"""The farthest, times this and `LEAST_M` more, is said beside the forecast (a choice, from flights)."""


class Foreseen(NamedTuple):
    """Where the law leads.

    Attributes:
        farthest_m: how far the hull leaves its path; infinite where that cannot be told.
        with_margin_m: the same with a margin for what the model does not know.
        going_on: whether it is still on its way out at the end of what was looked at.
    """

    farthest_m: float
    with_margin_m: float
    going_on: bool = False

    @property
    def words(self) -> str:
        """A few words for the log."""
        if self.farthest_m == inf:
            return f"foreseen beyond what can be told in {AHEAD_S:g} s"
        later = f" in {AHEAD_S:g} s, and farther later" * self.going_on
        return f"foreseen {in_metres(self.farthest_m)} m, {in_metres(self.with_margin_m)} m with a margin{later}"


class Ahead:
    """A hull and its law, flown on the equations of motion that the law knows.

    Args:
        follower: the law, moved on; a copy of the one that flies.
        thrusters: that are left.
        state: of the hull.
        forces: (k,) of those thrusters [N].
        applied: (6,) the wrench commanded at the tick before [N, N m].
        period_s: of a tick.
        force_ratio: share of their force that the supply leaves the thrusters.
        in_place: whether the law is to stay at a point, where every way off it counts.
        unknown: (6,) what pushes the hull beside all that is known [N, N m], body axes; None for nothing.

    Attributes:
        follower: the same.
        forces: (k,) of the thrusters by now [N].
        moved_by: what moves the hull: those thrusters, unless one does not do what it is told and nobody knows.
    """

    def __init__(
        self,
        follower: PathFollower,
        thrusters: LeftThrusters,
        state: State,
        forces: Vector,
        applied: Vector,
        period_s: float,
        force_ratio: float = 1.0,
        in_place: bool = False,
        unknown: Vector | None = None,
    ) -> None:
        self.follower = follower
        self._position, self._rotation = np.array(state.position), np.array(state.rotation)
        self._nu, self._applied = np.concatenate([state.velocity, state.rates]), np.array(applied)
        self._unknown = np.zeros(6) if unknown is None else unknown
        self._ratio, self._in_place = force_ratio, in_place
        self.go_on_with(thrusters, forces)
        self._tick = period_s * max(1, int(np.ceil(TICK_S / period_s - 1e-9)))
        self._steps = max(1, int(np.ceil(self._tick / STEP_S - 1e-9)))
        hull = follower.loops.dynamics
        self._hull, self._mobility = hull.record, np.linalg.inv(hull.total_mass)

        self._current_W = follower.current  # as it is believed by now, whatever the law learns of it ahead

    def go_on_with(self, thrusters: LeftThrusters, forces: Vector) -> None:
        """Let other thrusters do what the law asks for, which make (k,) forces by now [N]."""
        self.moved_by = self._thrusters = thrusters
        self.forces, self._asked = np.array(forces), np.array(forces)

    @property
    def state(self) -> State:
        """Of the hull by now."""
        R, nu = self._rotation.copy(), self._nu.copy()
        return State(self._position.copy(), np.array(quaternion_from_matrix(R)), R, nu[:3], nu[3:])

    def fly(self, seconds: float, until_back: bool = False) -> Vector:
        """How far it is off its path at each tick (n,) [m]; infinite at the last where that cannot be told any more.

        Args:
            seconds: how far to look.
            until_back: whether to end once the hull has come back.
        """
        off, farthest, at = [], 0.0, 0
        for k in range(max(1, round(seconds / self._tick))):
            decision = self.follower.decide(self.state, self._applied, self._tick, self._ratio)
            error = decision.view.error if self._in_place else decision.view.error[1:]
            off.append(float(np.linalg.norm(error)))
            if off[-1] > farthest:
                farthest, at = off[-1], k
            if until_back and (k - at) * self._tick >= BACK_S and off[-1] < max(LEAST_M, BACK * farthest):
                break
            make_wrench(self._thrusters, decision.wrench, decision.secondary, self._asked, self._applied)
            moved = self._rotation, self._position, self._nu
            told = self._unknown, self._current_W, self._asked, self.forces
            if not _move(self._hull, self._mobility, self.moved_by, *told, *moved, self._tick, self._steps):
                off.append(inf)
                break
        return np.array(off)


def in_metres(distance_m: float) -> str:
    """A distance in two digits; of less than a millimetre nobody can tell."""
    return f"{max(distance_m, LEAST_TOLD_M):.2g}"


def foreseen(off: Vector, off_otherwise: Vector | None = None, less_known_m: float = 0.0) -> Foreseen:
    """What is said of a flight ahead.

    Args:
        off: how far off it is at each tick (n,) [m], what the observer has learned being the push of the fault.
        off_otherwise: the same (k,) where that stays; None where nothing would.
        less_known_m: how much less is known of where the hull is.
    """
    farthest = float(np.max(off))
    worst = farthest if off_otherwise is None else max(farthest, float(np.max(off_otherwise)))
    late = off[len(off) // 2 :]
    going_on = bool(farthest > 2.0 * LEAST_M and np.argmax(off) == len(off) - 1 and late[-1] > 1.1 * late[0])
    return Foreseen(farthest, MARGIN * worst + LEAST_M + less_known_m, going_on or farthest == inf)


def carried_along(follower: PathFollower, state: State, off_m: float, less_known_m: float = 0.0) -> Foreseen:
    """What is said of a hull that gives its path up beside what is stuck: it holds its place, or is let carried.

    How that ends is not flown ahead: a search for where to hold takes long. An attempt that carries it farther than
    the others, all off, would have it carried is broken off, see `cube_sim.control.holding`.

    Args:
        follower: the law.
        state: of the hull.
        off_m: how far it is off its path already.
        less_known_m: how much less is known of where it is.
    """
    carried = _carried(follower, state)
    farthest = off_m + float(carried[-1])
    going_on = bool(carried[-1] > 1.1 * carried[len(carried) // 2])
    return Foreseen(farthest, MARGIN * farthest + 2.0 * ROOM_M + less_known_m, going_on)


def coasts_m(follower: PathFollower, state: State) -> float:
    """How far a hull goes while it is looked ahead if all thrusters that are not stuck are off [m]."""
    return float(_carried(follower, state)[-1])


def _carried(follower: PathFollower, state: State) -> Vector:
    """The largest distance from where it is within each second, thrusters off (n,) [m]."""
    nu = np.concatenate([state.velocity, state.rates])
    told = follower.loops.dynamics.record, follower.capability.held, state.rotation, nu, follower.current
    return carried_m(*told, round(AHEAD_S))


@compiled
def _move(hull, mobility, thrusters, unknown, current_W, asked, forces, R, position, nu, seconds, steps):
    """Move the hull on by the midpoint rule; whether what becomes of it is told."""
    h, push, middle = seconds / steps, np.empty(6), np.empty(6)
    current, still = triple(current_W), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for _ in range(steps):
        spin_up(thrusters, asked, forces, h, push)
        for i in range(6):
            push[i] += unknown[i]
        missing = minus6(sextuple(push), inverse_dynamics(hull, R, sextuple(nu), still, current))
        for i in range(6):
            middle[i] = nu[i]
            for j in range(6):
                middle[i] += 0.5 * h * mobility[i, j] * missing[j]
        missing = minus6(sextuple(push), inverse_dynamics(hull, R, sextuple(middle), still, current))
        for i in range(6):
            for j in range(6):
                nu[i] += h * mobility[i, j] * missing[j]
        if not gone_on(R, position, nu, h):
            return False
    return True
