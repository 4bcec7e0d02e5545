"""Which way of flying thrusters that work, are weak, dead or stuck leave, judged by what they and the water make."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

from cube_sim.actuation.attainable.attainable_set import attainable_set
from cube_sim.actuation.directions.subspaces import Subspaces, subspaces
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.actuation.path_following.verdict import judge
from cube_sim.control.authority import OUT_OF_PLANE, Authority, Capability
from cube_sim.control.effort import effort_matrix
from cube_sim.control.left_alone import carried_m
from cube_sim.control.levelling import UP
from cube_sim.control.pace import ForceBudget
from cube_sim.control.resting import nearest_rest, rests_amply
from cube_sim.control.turned_round import LOOKED_AHEAD_S, NEAR_M, drifts_aside, turned_round
from cube_sim.control.yielding import FORCES_YIELD, MAX_TILT_SINE, WaterHold, held_or_pointed
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import PLANAR, SPATIAL, WrenchAxes
from cube_sim.wrench.health import Health
from cube_sim.wrench.matrix import lever_arm
from cube_sim.wrench.tolerances import RANK_TOLERANCE

DEAR = 10.0
"""A direction that costs more than this many times the cheapest one's is left alone where the vehicle flies without."""
FASTEST_JUDGED_M_S = 0.3
"""A vehicle with components missing is asked for courses at this speed, or at its mission's own."""
NEARLY_LEVEL = 0.05
"""A thruster that pushes at the drag of a mission lifts by less than this share of it, and tilts the hull by less than
this [rad], where it counts as one for a level plane (a choice)."""
LITTLE_TILT = MAX_TILT_SINE
"""Sine of the tilt at which stuck thrusters may leave a hull that is flown at trim: the other half is for its drag."""
LIFTED = 0.5
"""Share of how far what is stuck lifts a vehicle for a level plane, within which it may wander instead (a choice)."""
LEANS = 0.87
"""Sine of the tilt, 60 degrees, to which a hull is turned to point its thrust beside what is stuck (a choice)."""
LEAST_SHARE = 0.1
"""A thruster that gives less than this share of a whole one's largest force is no way of moving."""


def remaining_capability(
    A: Matrix, limits: Matrix, health: Health, cost_limit: float | None = None, hold: WaterHold | None = None
) -> Capability:
    """Judge thrusters in the state they are in.

    Dead and stuck ones do not count, nor do those whose largest force is below `LEAST_SHARE` of a whole one's, or no
    larger than where their dead zone ends: the allocation may use them, but nobody steers by them.

    Args:
        A: (6,m) of all thrusters.
        limits: (m,4) of whole ones [F_max-, F_DZ-, F_DZ+, F_max+] [N].
        health: what is believed of them.
        cost_limit: see `capability`.
        hold: see `capability`.
    """
    passes_dead_zone = (limits[:, 0] < limits[:, 1]) | (limits[:, 3] > limits[:, 2])
    counts = health.responsive & (health.efficiency >= LEAST_SHARE) & passes_dead_zone
    held = A @ np.nan_to_num(health.stuck)
    left = capability(A[:, counts], held, cost_limit=cost_limit, whole=A, hold=hold)
    stuck = not np.all(np.isnan(health.stuck))
    if stuck and left.authority is Authority.TRIM and not (hold is not None and _tilts_little(left, hold)):
        # What stuck thrusters hold would tilt the hull far: where the attitude can point the thrust, it does.
        pointed = capability(A[:, counts], held, cost_limit=cost_limit, whole=A)
        left = left if pointed.authority is Authority.SAFE else pointed
    if not counts.any():
        return left
    weakened = limits[counts] * health.efficiency[counts, None]
    allowed = AllowedForces.from_limits(weakened, len(weakened), dead_zones=False)
    found = subspaces(A[:, counts], length_m=lever_arm(A, SPATIAL))
    largest = float(np.max(np.abs(limits), initial=0.0))
    which, share = np.flatnonzero(counts).astype(np.int64), health.efficiency[counts]
    budget = ForceBudget(attainable_set(found, allowed), left.held, A[:, counts], weakened[:, (0, 3)].T, which, share)
    left = replace(left, budget=budget, strongest=largest)
    if stuck and hold is not None and hold.hull is not None:
        left = _perhaps_turned(left, budget, hold.hull)
    if stuck or hold is None or hold.hull is None:
        return left
    if left.authority not in (Authority.TRIM, Authority.PLANE, Authority.LINE):
        return left
    # Slower than asked is slower, not lost: the analysis is asked at a speed that any vehicle should keep. But a hull
    # that is poorly steered there, where its level attitude is about to become unstable, may be well at its own speed.
    if hold.inclinations is not None:  # no slower: fins make less then
        required = PathRequirements(hold.speed, hold.inclinations, nose_ahead=True)
        verdict = judge(found, hold.hull, allowed, required)
        if verdict.follows:
            return replace(left, by_flow=True)
        return replace(left, authority=Authority.SAFE, reason=f"{verdict.reason}: the path cannot be followed")
    slow = min(hold.speed, FASTEST_JUDGED_M_S)
    verdict = judge(found, hold.hull, allowed, PathRequirements(speed_m_s=slow))
    if verdict.follows:
        return left
    if hold.speed > slow and judge(found, hold.hull, allowed, PathRequirements(speed_m_s=hold.speed)).follows:
        return left
    return replace(left, authority=Authority.SAFE, reason=f"{verdict.reason}: the path cannot be followed")


def _perhaps_turned(left: Capability, budget: ForceBudget, hull: Dynamics) -> Capability:
    """The same, or one that serves the force first in whichever attitude it has, where the model says it stays so."""
    lifted = abs(left.held[2]) > NEARLY_LEVEL * float(np.linalg.norm(left.held[:3]))
    if left.authority in (Authority.HOLONOMIC, Authority.TRIM) or (left.authority is Authority.LEVEL and not lifted):
        return left
    level, water, farthest = np.eye(3), np.zeros(3), NEAR_M
    if left.lost.shape[1] == 1 and not left.level and rests_amply(hull.record, budget, level):
        return left  # the attitude it has points the thrust
    if left.level and lifted:  # nothing else would make up for the lift
        carried = carried_m(hull.record, left.held, level, np.zeros(6), water, round(LOOKED_AHEAD_S))
        farthest = max(farthest, LIFTED * float(carried[-1]))
    turned = turned_round(hull, budget)
    if not turned.wanders_m < farthest:
        return left
    if (
        left.steers_by_attitude
        and _leans_at_most(LEANS, budget, hull)
        and drifts_aside(hull, budget, turned.torque, FASTEST_JUDGED_M_S)
    ):
        return left
    words = left.reason.rpartition(":")[0] or left.reason
    return replace(
        left,
        authority=Authority.TURNED,
        reason=f"{words}: the force comes first, in whichever attitude what is stuck turns it to",
        lost_forces=np.zeros((3, 0)),
        lost_torques=np.zeros((3, 0)),
        yielding=np.zeros((6, 0)),
        within_cost_limit=None,
        turned=turned,
    )


def _leans_at_most(sine: float, budget: ForceBudget, hull: Dynamics) -> bool:
    """Whether the thrusters hold it at rest beside what is stuck, tilted no further than that: it points them there."""
    rest = nearest_rest(hull.record, budget, 1.0, np.zeros(3), np.eye(3))
    return rest.held and float(rest.attitude[2, 2]) >= float(np.sqrt(1.0 - sine**2))


def _tilts_little(left: Capability, hold: WaterHold) -> bool:
    """Whether the water holds what stuck thrusters make of the torques that are left to it, at a small tilt."""
    torque = left.onto_range[1][3:]
    return float(np.hypot(torque[0], torque[1])) <= LITTLE_TILT * float(hold.righting[2])


def capability(
    A: Matrix,
    held: Vector | None = None,
    *,
    cost_limit: float | None = None,
    whole: Matrix | None = None,
    hold: WaterHold | None = None,
) -> Capability:
    """Judge thrusters that work.

    Args:
        A: (6,m) their columns.
        held: (6,) [N, N m] the wrench others hold beside them.
        cost_limit: directions of the wrench that cost more thruster force than this [N/N] count as lost, as those do
            for which thrusters are missing. By default those that cost `DEAR` times the cheapest one's, as long as the
            vehicle flies without them, else a hundred times.
        hold: what the water holds of the hull; default nothing.
        whole: (6,k) columns of all thrusters, whose rms lever arm makes torques and forces comparable for the limit.
    """
    constant = np.zeros(6) if held is None else held
    everything = A if whole is None else whole
    if A.shape[1] > 0 and _is_for_a_plane(A, hold):
        rows = ~OUT_OF_PLANE
        found = _in_plane(A[rows], constant[rows], _cost_arguments(cost_limit, everything[rows], PLANAR))
    else:
        found = _in_space(
            A, constant, _cost_arguments(cost_limit, everything, SPATIAL), hold, lever_arm(everything, SPATIAL)
        )
    return Capability(
        authority=found.authority,
        pure_forces=found.pure_forces,
        reason=found.reason,
        lost_forces=found.lost[:3],
        lost_torques=found.lost[3:],
        yielding=FORCES_YIELD @ found.lost if found.yielding is None else found.yielding,
        effort=effort_matrix(A, cost_limit),
        held=constant,
        within_cost_limit=found.within_cost_limit,
    )


def _is_for_a_plane(A: Matrix, hold: WaterHold | None) -> bool:
    """Whether thrusters make nothing but surge, sway and yaw, and what comes with these the water holds.

    Heave, roll and pitch of their own are none of it: the rank of A is that of its rows for the plane.
    """
    out = np.abs(A[OUT_OF_PLANE])
    if not np.any(out > 1e-9):
        return True
    level = A[~OUT_OF_PLANE]
    _, sigma, Vt = np.linalg.svd(level, full_matrices=False)
    spanned = Vt[sigma > RANK_TOLERANCE * sigma[0]]
    own = A[OUT_OF_PLANE] - A[OUT_OF_PLANE] @ spanned.T @ spanned
    if hold is None or np.any(np.abs(own) > 1e-9):
        return False
    lifts, tilts = out[0], np.hypot(out[1], out[2]) * hold.force[0]
    return bool(np.all(lifts < NEARLY_LEVEL) and np.all(tilts < NEARLY_LEVEL * hold.righting[2]))


class _Finding(NamedTuple):
    """What geometry says: how to fly, pure forces (3,p), lost combinations (6, 6 - rank) and the line for the log."""

    authority: Authority
    pure_forces: Matrix
    lost: Matrix
    reason: str
    within_cost_limit: Matrix | None = None
    yielding: Matrix | None = None


class _CostArguments(TypedDict, total=False):
    """Arguments of `subspaces`."""

    cost_limit: float
    length_m: float


def _cost_arguments(cost_limit: float | None, whole: Matrix, axes: WrenchAxes) -> _CostArguments:
    return {} if cost_limit is None else {"cost_limit": cost_limit, "length_m": lever_arm(whole, axes)}


def _cost_projector(space: Subspaces, rows: NDArray[np.bool_]) -> Matrix | None:
    """The projector (6,6) onto the directions within the cost limit in these rows of a wrench, None when all are."""
    if "cost" not in space.threshold.dropped(space.singular_values):
        return None
    projector = np.zeros((6, 6))
    projector[np.ix_(rows, rows)] = space.projector
    return projector


def _in_space(A: Matrix, held: Vector, cost: _CostArguments, hold: WaterHold | None, length_m: float) -> _Finding:
    if A.shape[1] == 0:
        return _Finding(Authority.SAFE, np.zeros((3, 0)), np.eye(6), "no thruster is left")
    if not cost:
        cheap = _in_space(
            A, held, _CostArguments(cost_limit=DEAR * _cheapest(A, length_m), length_m=length_m), hold, length_m
        )
        if cheap.authority is not Authority.SAFE:
            return cheap
    space = subspaces(A, **cost)
    within = _cost_projector(space, np.ones(6, dtype=bool))
    lost = np.array([combination.coefficients for combination in space.unreachable]).reshape(-1, 6).T
    if space.rank == 6:
        return _Finding(Authority.HOLONOMIC, np.eye(3), lost, "all six components of the wrench are there")
    words = "; ".join(combination.beside(held) for combination in space.unreachable)
    found = held_or_pointed(lost, hold, UP, length_m)
    if found is None or found.pointed == 3:
        return _Finding(Authority.SAFE, space.pure_forces, lost, f"{words}: the path cannot be followed", within)
    authority, text = {
        0: (Authority.TRIM, "the water holds what is missing"),
        1: (Authority.PLANE, "the attitude now points the thrust"),
        2: (Authority.LINE, "the attitude now points the thrust"),
    }[found.pointed]
    return _Finding(authority, space.pure_forces, lost, f"{words}: {text}", within, found.directions)


def _cheapest(A: Matrix, length_m: float) -> float:
    """What the cheapest direction of the wrench costs [N/N]."""
    return 1.0 / float(np.linalg.norm(SPATIAL.scale(length_m)[:, None] * A, 2))


def _in_plane(A: Matrix, held: Vector, cost: _CostArguments) -> _Finding:
    """The same for surge, sway and yaw (3,m); to stay upright is the hull's own business."""
    space = subspaces(A, **cost)
    within = _cost_projector(space, ~OUT_OF_PLANE)
    lost = np.zeros((6, len(space.unreachable)))
    for column, combination in zip(lost.T, space.unreachable, strict=True):
        column[~OUT_OF_PLANE] = combination.coefficients
    pure_forces = np.zeros((3, space.pure_forces.shape[1]))
    pure_forces[:2] = space.pure_forces[:2]
    if space.rank == 3:
        return _Finding(Authority.LEVEL, pure_forces, lost, "it moves in a level plane")
    words = "; ".join(combination.beside(held) for combination in space.unreachable)
    if space.rank == 2 and _steerable(lost):
        return _Finding(Authority.UNICYCLE, pure_forces, lost, f"{words}: the heading now points the thrust", within)
    return _Finding(Authority.SAFE, pure_forces, lost, f"{words}: the path cannot be followed", within)


def _steerable(lost: Matrix) -> bool:
    """Whether every torque comes with some force: exactly when the lost combinations differ in their force parts."""
    singular = np.linalg.svd(lost[:3], compute_uv=False)
    return len(singular) == lost.shape[1] and bool(singular[-1] > RANK_TOLERANCE)
