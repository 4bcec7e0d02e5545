"""Everything about one vehicle's allocation that stays from call to call."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.planar_vertices import suits_lines
from cube_sim.allocation.exact.relaxation import relax
from cube_sim.allocation.exact.solutions import WrenchDistance, WrenchFibre, torque_rows
from cube_sim.wrench.facets import facet_normals


class Tables(NamedTuple):
    """One vehicle, one objective.

    Attributes:
        A: (n, m) actuation matrix.
        error_scale: (n,) 1 for forces, 1/length for torques.
        fibre: all forces that make a wrench.
        plane: (m, 2) the fibre's kernel with columns of zeros for missing dimensions, for `line_search`.
        planar: whether `line_search` may be used.
        scaled: whether an unattainable wrench is scaled rather than answered by the closest one.
        weights: (m,) w.
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
        masks: (m,) bits of the sides that are not empty.
        targets: (t, m, 3) alternatives of the objective [N].
        penalty: (m, 3) zeros.
        relaxed: (t, m, 8, 4) from `relax` without penalties.
        edge: (m, 3) force at which a motor enters each side [N], from where changes are counted.
        reversal_penalty: price of one motor changing its direction of push [N^2].
        switching_penalty: price of one motor starting from rest or coming to rest [N^2].
        change_limit: most a motor's force may change in one call, dead zone not counted [N]; infinite for no limit.
        tolerance: force that counts as rounding [N].
        reach: largest force or torque the vehicle can make along one axis [N], [N m].
    """

    A: NDArray[np.float64]
    error_scale: NDArray[np.float64]
    fibre: WrenchFibre
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
    change_limit: float
    tolerance: float
    reach: float


class Beyond(NamedTuple):
    """What unattainable wrenches need besides.

    Attributes:
        distance: the norm of wrench errors.
        facets: (h, r) normals across which a demand is scaled, in the coordinates s of ``distance``; h = 0 as long as
            none is.
    """

    distance: WrenchDistance
    facets: NDArray[np.float64]


def make_tables(
    A: NDArray[np.float64],
    fibre: WrenchFibre,
    sides: tuple[NDArray[np.float64], NDArray[np.float64]],
    weights: NDArray[np.float64],
    targets: NDArray[np.float64],
    *,
    reversal_penalty: float,
    switching_penalty: float,
    change_limit: float,
    tolerance: float,
    length_m: float,
    scaled: bool,
) -> Tables:
    """Tabulate; see `Tables` for the arguments. ``sides`` are ``low`` and ``high``."""
    n, m = A.shape
    k = fibre.kernel.shape[1]
    low, high = sides
    plane = np.zeros((m, 2))
    if k <= 2:
        plane[:, :k] = fibre.kernel
    error_scale = np.ones(n)
    error_scale[torque_rows(n)] = 1.0 / length_m
    uniform = bool(np.all(targets == targets[:, :, :1]))
    relaxed, penalty = np.empty((len(targets), m, 8, 4)), np.zeros((m, 3))
    for target, table in zip(targets, relaxed, strict=True):
        relax(low, high, target, penalty, weights, table)
    open_side = low <= high
    strongest = np.max(np.where(open_side, np.maximum(np.abs(low), np.abs(high)), 0.0), axis=1)
    edges = np.where(open_side[:, 0], high[:, 0], 0.0), np.zeros(m), np.where(open_side[:, 2], low[:, 2], 0.0)
    return Tables(
        A=A,
        error_scale=error_scale,
        fibre=fibre,
        plane=plane,
        planar=bool(uniform and k <= 2 and suits_lines(plane)),
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
        change_limit=change_limit,
        tolerance=tolerance,
        reach=float(np.max(np.abs(A) @ strongest)),
    )


def beyond(distance: WrenchDistance, *, facets: bool) -> Beyond:
    """Tabulate; with the facets that scaling and yielding go by, or without."""
    return Beyond(distance, facet_normals(distance.gain) if facets else np.zeros((0, len(distance.gain))))
