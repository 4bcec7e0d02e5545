"""Attitudes in which a hull is held at rest beside what its stuck thrusters do, and the one carried off least.

In an attitude the thrusters that work make of the wrench that rest asks for what they can: its torque first, or the
hull does not stay there, then as much of its force as is left. What is missing of the force carries the hull off.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.control.nearest_forces import QUICK, nearest_forces
from cube_sim.control.pace import ForceBudget
from cube_sim.control.roomiest_attitude import excess, spread_attitudes
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.tuples import rotated, to_body, triple
from cube_sim.vehicle.laws.hull_motion import steady_wrench
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm

TORQUE_FIRST = 5.0
"""How many times a torque that is missing counts as much as the force it takes on the thrusters' rms arm (a choice)."""
STEPS_RAD = np.array([0.3, 0.15, 0.075, 0.04, 0.02, 0.01, 0.005])
"""Turns by which an attitude is made better, the large ones first."""
STARTS = 12
"""How many of the attitudes spread over all are made better so."""
SHARES = (0.9, 1.0)
"""Of their force that thrusters may use in an attitude to rest in: with something to brake with if there is one."""
AMPLE = 0.8
"""The same where there is enough to spare for all that moving asks for (a choice)."""
AT_REST = 0.02
"""Share of what is stuck, or of `LITTLE` of the largest force, below which a missing wrench counts as none."""
LITTLE = 0.1


class Rest(NamedTuple):
    """An attitude to rest in, or the one where least is missing for it.

    Attributes:
        attitude: R_WB (3,3).
        missing: the wrench (6,) that is missing for rest there [N, N m], body axes.
        held: whether that is next to nothing.
    """

    attitude: Matrix
    missing: Vector
    held: bool


class _Reckoned(NamedTuple):
    """Arguments of the compiled functions, everything in newtons: torques over the thrusters' rms arm."""

    matrix: Matrix
    gram: Vector
    least: Vector
    most: Vector
    stuck: Vector
    scale: Vector


def nearest_rest(hull: Record, budget: ForceBudget, force_ratio: float, flow_W: Vector, near: Matrix) -> Rest:
    """The attitude nearest to one in which the thrusters hold the hull at rest; if there is none, the best there is.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        budget: what the thrusters can make, and what is stuck.
        force_ratio: share of their force that the supply leaves the thrusters.
        flow_W: velocity through the water at rest (3,) [m/s], world axes.
        near: R_WB (3,3).
    """
    if surely_rests(hull, budget, SHARES[0] * force_ratio, flow_W, near):
        return Rest(near, np.zeros(6), True)
    found, scale = [], _reckoned(budget, force_ratio).scale
    attitudes = np.concatenate([near[None], _headed_like(near), spread_attitudes()])
    for share in SHARES:
        reckoned = _reckoned(budget, share * force_ratio)
        good = _little(budget, reckoned)
        sizes = np.empty(len(attitudes))
        look_round(hull, *reckoned, flow_W, attitudes, sizes)
        starts = [0, *(int(i) for i in np.argsort(sizes, kind="stable")[:STARTS])]
        found = [_made_better(hull, reckoned, flow_W, attitudes[i], good) for i in starts]
        at_rest = [rest for rest in found if rest.held]
        if at_rest:
            return max(at_rest, key=lambda rest: float(np.sum(rest.attitude * near)))
    return min(found, key=lambda rest: float(np.linalg.norm(scale * rest.missing)))


def surely_rests(hull: Record, budget: ForceBudget, force_ratio: float, flow_W: Vector, attitude: Matrix) -> bool:
    """Whether the facets of what the thrusters make hold a hull at rest in an attitude; arguments as above.

    They tell it exactly where all six components are there. Forces sought step by step may come to less: where columns
    are nearly alike, as of a layout drawn by chance, many steps lead there.
    """
    if np.linalg.matrix_rank(budget.matrix) < 6:
        return False
    offsets = np.ascontiguousarray(budget.attainable.offsets)
    return bool(excess(hull, budget.normals, offsets, budget.held_shares, force_ratio, triple(flow_W), attitude) <= 0.0)


def rest_in(hull: Record, budget: ForceBudget, attitude: Matrix) -> Rest:
    """What is missing for rest in an attitude (3,3), in still water.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        budget: what the thrusters can make, and what is stuck.
        attitude: R_WB.
    """
    reckoned, residual = _reckoned(budget, 1.0), np.empty(6)
    size = what_is_missing(hull, *reckoned, (0.0, 0.0, 0.0), attitude, residual)
    return Rest(attitude, residual / reckoned.scale, bool(size <= _little(budget, reckoned)))


def rests_amply(hull: Record, budget: ForceBudget, attitude: Matrix) -> bool:
    """Whether the thrusters hold a hull at rest in an attitude (3,3), in still water, with `AMPLE` of their force.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        budget: what the thrusters can make, and what is stuck.
        attitude: R_WB (3,3).
    """
    reckoned = _reckoned(budget, AMPLE)
    size = what_is_missing(hull, *reckoned, (0.0, 0.0, 0.0), attitude, np.empty(6))
    return bool(size <= _little(budget, reckoned))


def _reckoned(budget: ForceBudget, share: float) -> _Reckoned:
    """With thrusters that may use a share of their force."""
    scale = SPATIAL.scale(lever_arm(budget.matrix, SPATIAL)) * np.array([1.0] * 3 + [TORQUE_FIRST] * 3)
    matrix = np.ascontiguousarray(scale[:, None] * budget.matrix)
    least, most = share * budget.limits
    return _Reckoned(matrix, np.sum(matrix**2, axis=0), least, most, scale * budget.held, scale)


def _little(budget: ForceBudget, reckoned: _Reckoned) -> float:
    """Squared, what is missing where next to nothing is [N^2]."""
    largest = float(np.max(np.abs(budget.limits), initial=0.0))
    return (AT_REST * max(float(np.linalg.norm(reckoned.stuck)), LITTLE * largest)) ** 2


def _headed_like(near: Matrix) -> Matrix:
    """The attitudes spread over all, each turned about the vertical to where it is nearest to another (3,3)."""
    spread = spread_attitudes()
    product = np.einsum("kij,lj->kil", spread, near)
    angle = np.arctan2(product[:, 0, 1] - product[:, 1, 0], product[:, 0, 0] + product[:, 1, 1])
    c, s, turn = np.cos(angle), np.sin(angle), np.zeros_like(spread)
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = c, -s, s, c, 1.0
    return turn @ spread


def _made_better(hull: Record, reckoned: _Reckoned, flow_W: Vector, start: Matrix, good: float) -> Rest:
    """The attitude that is found from a start, turning to where less is missing until no more than `good` is."""
    residual = np.empty(6)
    attitude, size = turn_to_less(hull, *reckoned, flow_W, start, good, STEPS_RAD, residual)
    return Rest(attitude, residual / reckoned.scale, size <= good)


@compiled
def what_is_missing(hull, matrix, gram, least, most, stuck, scale, flow, R, residual):
    """What is missing for rest in an attitude (3,3), into `residual` (6,), scaled; returns its size squared [N^2].

    gram (k,) is the square of each column.
    """
    wrench, forces = steady_wrench(hull, to_body(R, flow), (R[2, 0], R[2, 1], R[2, 2])), np.zeros(len(least))
    for i in range(6):
        residual[i] = scale[i] * wrench[i] - stuck[i]
    nearest_forces(matrix, gram, least, most, QUICK, residual, forces)
    size = 0.0
    for i in range(6):
        size += residual[i] * residual[i]
    return size


@compiled
def look_round(hull, matrix, gram, least, most, stuck, scale, flow_W, attitudes, sizes):
    """What is missing in each of the attitudes (q,3,3), squared [N^2], into `sizes` (q,)."""
    flow, residual = triple(flow_W), np.empty(6)
    for q in range(len(attitudes)):
        R = attitudes[q]
        sizes[q] = what_is_missing(hull, matrix, gram, least, most, stuck, scale, flow, R, residual)


@compiled
def turn_to_less(hull, matrix, gram, least, most, stuck, scale, flow_W, start, good, steps, residual):
    """An attitude turned step by step to where less is missing, and how much is, squared [N^2]; `residual` filled."""
    flow, R = triple(flow_W), start
    best = what_is_missing(hull, matrix, gram, least, most, stuck, scale, flow, R, residual)
    for step in steps:
        moved = True
        while moved and best > good:
            moved = False
            for k in range(6):
                spin = (1.0 if k % 3 == 0 else 0.0, 1.0 if k % 3 == 1 else 0.0, 1.0 if k % 3 == 2 else 0.0)
                tried = rotated(R, spin, step if k < 3 else -step)
                size = what_is_missing(hull, matrix, gram, least, most, stuck, scale, flow, tried, residual)
                if size < 0.999 * best:
                    best, R, moved = size, tried, True
    best = what_is_missing(hull, matrix, gram, least, most, stuck, scale, flow, R, residual)
    return R, best
