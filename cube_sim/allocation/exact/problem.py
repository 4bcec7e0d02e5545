"""Everything about one vehicle's allocation that stays from call to call."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.planar_lines import suits_planar_search
from cube_sim.allocation.exact.relaxation import relax
from cube_sim.allocation.exact.solutions import ForceSolutions, WrenchMetric
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.facets import facet_normals
from cube_sim.wrench.tolerances import MATRIX_ROUNDING


class AllocationProblem(NamedTuple):
    """One vehicle, one objective: what the search takes from call to call.

    Attributes:
        A: (n, m) actuation matrix.
        error_scale: (n,) 1 for forces, 1/length for torques.
        solutions: all forces that make a wrench.
        plane: (m, 2) their null space, with columns of zeros for missing dimensions, for `planar_search`.
        planar: whether `planar_search` may be used.
        scaled: whether an unattainable wrench is scaled rather than answered by the closest one.
        weights: (m,) w.
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
        masks: (m,) bits of the sides that are not empty: 1 negative, 2 off, 4 positive.
        targets: (t, m, 3) alternatives of the objective [N].
        penalty: (m, 3) zeros.
        relaxed: (t, m, 8, 4) from `relax` without penalties.
        edge: (m, 3) force at which a thruster enters each side [N]. Changes of force are counted from there.
        reversal_penalty: cost of one thruster changing its direction of push [N^2].
        switching_penalty: cost of one thruster starting from rest or coming to rest [N^2].
        dwell_calls: calls on a side up to which leaving it costs a whole penalty; from then on it falls in proportion.
        change_limit: most a thruster's force may change in one call [N]. The dead zone is not counted. Infinite for
            no limit.
        tolerance: force that counts as rounding [N].
        hidden: force that the rounding of A's entries hides [N], `tolerance` at least.
        largest_wrench: largest force or torque the vehicle can make along one axis [N], [N m].
    """

    A: NDArray[np.float64]
    error_scale: NDArray[np.float64]
    solutions: ForceSolutions
    plane: NDArray[np.float64]
    planar: bool
    scaled: bool
    weights: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    masks: NDArray[np.int64]
    targets: NDArray[np.float64]
    penalty: NDArray[np.float64]
    relaxed: NDArray[np.float64]
    edge: NDArray[np.float64]
    reversal_penalty: float
    switching_penalty: float
    dwell_calls: float
    change_limit: float
    tolerance: float
    hidden: float
    largest_wrench: float


class ClosestWrenchData(NamedTuple):
    """What the answer to an unattainable wrench needs besides.

    Attributes:
        metric: the norm of wrench errors.
        facets: (h, r) normals of the facets of attainable wrenches, in the coordinates s of ``metric``. They bound the
            share of a demand that is made. h = 0 as long as no demand is scaled and none yields.
    """

    metric: WrenchMetric
    facets: NDArray[np.float64]


def make_problem(
    A: NDArray[np.float64],
    solutions: ForceSolutions,
    sides: tuple[NDArray[np.float64], NDArray[np.float64]],
    weights: NDArray[np.float64],
    targets: NDArray[np.float64],
    *,
    reversal_penalty: float,
    switching_penalty: float,
    dwell_calls: float,
    change_limit: float,
    tolerance: float,
    length_m: float,
    scaled: bool,
) -> AllocationProblem:
    """Tabulate one vehicle and one objective; see `AllocationProblem` for the arguments.

    Args:
        A: (n, m).
        solutions: of A.
        sides: ``low`` and ``high``.
        weights: (m,).
        targets: (t, m, 3) [N].
        reversal_penalty: [N^2].
        switching_penalty: [N^2].
        dwell_calls: see `AllocationProblem`.
        change_limit: [N].
        tolerance: [N].
        length_m: divides torques wherever a wrench error is one number [m].
        scaled: whether an unattainable wrench is scaled.
    """
    n, m = A.shape
    k = solutions.null_space.shape[1]
    low, high = sides
    plane = np.zeros((m, 2))
    if k <= 2:
        plane[:, :k] = solutions.null_space
    uniform = bool(np.all(targets == targets[:, :, :1]))
    relaxed, penalty = np.empty((len(targets), m, 8, 4)), np.zeros((m, 3))
    for target, table in zip(targets, relaxed, strict=True):
        relax(low, high, target, penalty, weights, table)
    open_side = low <= high
    strongest = np.max(np.where(open_side, np.maximum(np.abs(low), np.abs(high)), 0.0), axis=1)
    edges = np.where(open_side[:, 0], high[:, 0], 0.0), np.zeros(m), np.where(open_side[:, 2], low[:, 2], 0.0)
    return AllocationProblem(
        A=A,
        error_scale=axes_of(n).scale(length_m),
        solutions=solutions,
        plane=plane,
        planar=bool(uniform and k <= 2 and suits_planar_search(plane)),
        scaled=scaled,
        weights=weights,
        low=low,
        high=high,
        masks=(open_side * (1, 2, 4)).sum(axis=1),
        targets=np.ascontiguousarray(targets),
        penalty=penalty,
        relaxed=relaxed,
        edge=np.ascontiguousarray(np.column_stack(edges)),
        reversal_penalty=reversal_penalty,
        switching_penalty=switching_penalty,
        dwell_calls=dwell_calls,
        change_limit=change_limit,
        tolerance=tolerance,
        hidden=max(tolerance, MATRIX_ROUNDING * float(np.max(strongest))),
        largest_wrench=float(np.max(np.abs(A) @ strongest)),
    )


def closest_wrench_data(metric: WrenchMetric, *, facets: bool) -> ClosestWrenchData:
    """Tabulate a metric; with the facets that scaling and yielding go by, or without."""
    return ClosestWrenchData(metric, facet_normals(metric.G) if facets else np.zeros((0, len(metric.G))))
