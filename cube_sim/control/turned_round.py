"""Where a hull goes that what is stuck turns round, if its force is served first in whichever attitude it is by then.

A thruster that is stuck may turn the hull in any attitude there is, and then none points the thrust of the others. But
what is stuck turns with the hull, so that it may lead nowhere, and so do the directions in which the others push. No
balance of forces tells how that ends: the equations of motion are integrated, with the law in them.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from cube_sim.control.force_first import TORQUE, ForceFirst, serve_force_first
from cube_sim.control.holding import carried_off_m
from cube_sim.control.left_alone import gone_on
from cube_sim.control.loop_times import LoopTimes
from cube_sim.control.loops import MotionLoops, loop_wrench
from cube_sim.control.pace import ForceBudget
from cube_sim.control.priority import force_with_torque
from cube_sim.control.resting import rest_in
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Vector, rotation_about
from cube_sim.tuples import (
    length,
    minus6,
    quaternion_from_matrix,
    sextuple,
    times,
    triple,
)
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics

LOOKED_AHEAD_S = 40.0
"""How far ahead it is worked out where the hull goes (a choice)."""
STEP_S = 0.05
"""Of the integration."""
DELAY_S = 0.05
"""Behind which the loops would be as quick as those that are reckoned with (a choice)."""
NEAR_M = 0.5
"""Within this a hull is near its place (a choice)."""
LET_TURN = 0.01
"""What a torque counts where the hull is let turn: next to nothing."""
BETTER = 0.5
"""Share of how far it is off otherwise, below which it is let turn (a choice)."""
START = rotation_about(np.array([0.6, 0.8, 0.0]), 0.15)
"""R_WB from which it begins: no hull lies so level that what would turn it over does not."""
OVER = 2.0
"""It is told of a hull that stays level where that leads so many times as far as to be turned over (a choice)."""
LEAST_TOLD_M = 0.01
"""To less nobody can tell (a choice)."""
STEADIED = 0.5
"""Share of the time looked ahead after which it counts how far off it is: by then it turns as it goes on turning."""
DRIFTS = 0.5
"""Share of the water's way after that time, beyond which a hull goes along with it (a choice)."""


class TurnedRound(NamedTuple):
    """How a hull is best flown that is turned round.

    Attributes:
        wanders_m: how far from its place it is at most, once it turns steadily; infinite where it cannot be told.
        torque: what a missing torque counts beside a force, see `cube_sim.control.force_first.TORQUE`.
        level_m: how far it is carried meanwhile if it stays level; 0 where it does not matter, or does not stay so.
    """

    wanders_m: float
    torque: float
    level_m: float = 0.0

    @property
    def words(self) -> str:
        """One clause for the log: how far it will be off, and that this is no bound."""
        wanders = f"it wanders by {max(self.wanders_m, LEAST_TOLD_M):.2g} m"
        if self.level_m < OVER * self.wanders_m:
            return f"turned round by what is stuck, {wanders}, by its equations of motion"
        level = f"as long as it stays level it is carried off, {self.level_m:.2g} m in {LOOKED_AHEAD_S:g} s"
        return f"once what is stuck turns it over {wanders}; {level}, by its equations of motion"


def turned_round(hull: Dynamics, budget: ForceBudget) -> TurnedRound:
    """The better of two ways: to fight for the attitude with what the force leaves, or to let it turn.

    To let it turn is taken where the other leaves it far off, and twice as far: that may yet come to rest.
    """
    kept = wanders_m(hull, budget, TORQUE)
    if kept < NEAR_M:
        return TurnedRound(kept, TORQUE)
    let = wanders_m(hull, budget, LET_TURN)
    best = TurnedRound(let, LET_TURN) if let < BETTER * kept else TurnedRound(kept, TORQUE)
    if best.wanders_m < NEAR_M:
        return best
    level = rest_in(hull.record, budget, np.eye(3))
    stays = 0.0 if level.held else carried_off_m(hull, budget, level, round(LOOKED_AHEAD_S))
    return best._replace(level_m=stays if stays < inf else 0.0)


def wanders_m(hull: Dynamics, budget: ForceBudget, torque: float) -> float:
    """How far from its place a hull is at most, once it turns steadily [m]; it begins at rest, nearly level.

    Args:
        hull: the body.
        budget: what the thrusters can make, and what is stuck.
        torque: what a missing torque counts.
    """
    off = _off_m(hull, budget, torque, np.zeros(3))
    return float(np.max(off[_steadied(off) :]))


def drifts_aside(hull: Dynamics, budget: ForceBudget, torque: float, speed_m_s: float) -> bool:
    """Whether a hull goes along with water that comes from a side, at a speed.

    What is stuck may have turned it to where it is turned no further, and none of the others pushes it to that side:
    it stays in still water, and nowhere else.

    Args:
        hull: the body.
        budget: what the thrusters can make, and what is stuck.
        torque: what a missing torque counts.
        speed_m_s: of the water.
    """
    way = speed_m_s * (1.0 - STEADIED) * LOOKED_AHEAD_S
    for aside in (speed_m_s, -speed_m_s):
        off = _off_m(hull, budget, torque, np.array([0.0, aside, 0.0]))
        if not float(off[-1] - off[_steadied(off)]) < DRIFTS * way:
            return True
    return False


def _steadied(off: Vector) -> int:
    return round(STEADIED * len(off))


def _off_m(hull: Dynamics, budget: ForceBudget, torque: float, current_W: Vector) -> Vector:
    """How far it is off its place after each step (n,) [m]; infinite from where on it cannot be told."""
    loop = LoopTimes.behind(DELAY_S)
    loops = MotionLoops(hull, loop.velocity, loop.attitude, loop.rate).record
    coupling, mobility = force_with_torque(hull.total_mass), np.linalg.inv(hull.total_mass)
    parts = ForceFirst.of(budget, coupling, True, torque)
    facets, off = (budget.normals, budget.held_shares), np.full(round(LOOKED_AHEAD_S / STEP_S), np.inf)
    _turn(hull.record, loops, parts, *facets, mobility, loop.lateral, np.array(START), current_W, off)
    return off


@compiled
def _turn(hull, loops, parts, normals, held_shares, mobility, lateral_time, R, current_W, off):
    """Fill how far it is off its place after each step [m]; R is moved on."""
    position, nu, wrench = np.zeros(3), np.zeros(6), np.empty(6)
    current, none, q_d = triple(current_W), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    still = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(len(off)):
        back = times(-1.0 / lateral_time, triple(position))
        asked = loop_wrench(
            hull, loops, R, quaternion_from_matrix(R), triple(nu), triple(nu[3:]), back, none, q_d, none, current
        )[0]
        for i in range(6):
            wrench[i] = asked[i]
        serve_force_first(parts, normals, held_shares, 1.0, wrench)
        missing = minus6(sextuple(wrench), inverse_dynamics(hull, R, sextuple(nu), still, current))
        for i in range(6):
            for j in range(6):
                nu[i] += STEP_S * mobility[i, j] * missing[j]
        if not gone_on(R, position, nu, STEP_S):
            return
        off[k] = length(triple(position))
