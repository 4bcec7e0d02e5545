"""Everything about one vehicle's allocation that stays from call to call, in the form compiled code takes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.facets import facet_normals
from cube_sim.allocation.geometry import WrenchDistance, WrenchFibre, torque_rows
from cube_sim.allocation.lines import suits_lines
from cube_sim.allocation.relaxation import relax
from cube_sim.compiled import compiled


class Packed(NamedTuple):
    """`Tables` in two arrays: what a compiled call is handed costs time by the piece.

    Attributes:
        numbers: every float of the tables, field after field.
        integers: n, m, k, rank A, number of alternatives, planar, h, scaled, rank W A, then the masks of the m motors.
    """

    numbers: NDArray[np.float64]
    integers: NDArray[np.int64]


class Tables(NamedTuple):
    """One vehicle, one objective.

    Attributes:
        A: (n, m) actuation matrix.
        error_scale: (n,) 1 for forces, 1/length for torques.
        fibre: all forces that make a wrench.
        plane: (m, 2) the fibre's kernel with columns of zeros for missing dimensions, for `line_search`.
        planar: whether `line_search` may be used.
        distance: the norm of wrench errors.
        facets: (h, r) normals across which a demand is scaled, in the coordinates s of ``distance``; h = 0 as long as
            none is.
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
    distance: WrenchDistance
    facets: NDArray[np.float64]
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


def make_tables(
    A: NDArray[np.float64],
    fibre: WrenchFibre,
    distance: WrenchDistance,
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
    """Tabulate, without facets; see `Tables` for the arguments. ``sides`` are ``low`` and ``high``."""
    n, m = A.shape
    k = fibre.kernel.shape[1]
    low, high = sides
    plane = np.zeros((m, 2))
    if k <= 2:
        plane[:, :k] = fibre.kernel
    error_scale = np.ones(n)
    error_scale[torque_rows(n)] = 1.0 / length_m
    uniform = bool(np.all(targets == targets[:, :, :1]))
    tables = Tables(
        A=A,
        error_scale=error_scale,
        fibre=fibre,
        plane=plane,
        planar=bool(uniform and k <= 2 and suits_lines(plane)),
        distance=distance,
        facets=np.zeros((0, len(distance.gain))),
        scaled=scaled,
        weights=weights,
        low=low,
        high=high,
        masks=np.zeros(m, np.int64),
        targets=np.ascontiguousarray(targets),
        penalty=np.zeros((m, 3)),
        relaxed=np.empty((len(targets), m, 8, 4)),
        edge=np.zeros((m, 3)),
        reversal_penalty=reversal_penalty,
        switching_penalty=switching_penalty,
        change_limit=change_limit,
        tolerance=tolerance,
        reach=0.0,
    )
    return with_sides(tables, low, high)


def with_sides(tables: Tables, low: NDArray[np.float64], high: NDArray[np.float64]) -> Tables:
    """The same vehicle with other allowed forces: only what follows from them is tabulated anew.

    Args:
        tables: of the vehicle.
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
    """
    m = len(low)
    relaxed, penalty = np.empty_like(tables.relaxed), np.zeros((m, 3))
    for target, table in zip(tables.targets, relaxed, strict=True):
        relax(low, high, target, penalty, tables.weights, table)
    open_side = low <= high
    strongest = np.max(np.where(open_side, np.maximum(np.abs(low), np.abs(high)), 0.0), axis=1)
    return tables._replace(
        low=low,
        high=high,
        masks=(open_side * (1, 2, 4)).sum(axis=1),
        penalty=penalty,
        relaxed=relaxed,
        edge=np.ascontiguousarray(
            np.column_stack(
                [np.where(open_side[:, 0], high[:, 0], 0.0), np.zeros(m), np.where(open_side[:, 2], low[:, 2], 0.0)]
            )
        ),
        reach=float(np.max(np.abs(tables.A) @ strongest)),
    )


def with_facets(tables: Tables) -> Tables:
    """The same with the facets that scaling and yielding go by."""
    return tables._replace(facets=facet_normals(tables.distance.gain))


def pack(t: Tables) -> Packed:
    """Put tables into two pieces, in the order `unpack` takes them out."""
    fibre, distance = t.fibre, t.distance
    floats = (
        t.A, t.error_scale, fibre.particular, fibre.kernel, fibre.equations, fibre.unreachable, t.plane,
        distance.spread, distance.kernel, distance.basis, distance.gain, distance.weights, t.facets, t.weights, t.low,
        t.high, t.targets, t.penalty, t.relaxed, t.edge, t.reversal_penalty, t.switching_penalty, t.change_limit,
        t.tolerance, t.reach,
    )  # fmt: skip
    integers = (
        *t.A.shape, fibre.kernel.shape[1], fibre.rank, len(t.targets), t.planar, len(t.facets), t.scaled,
        len(distance.gain), *t.masks,
    )  # fmt: skip
    return Packed(np.concatenate([np.ravel(part) for part in floats]), np.array(integers, np.int64))


@compiled
def unpack(numbers: NDArray[np.float64], integers: NDArray[np.int64]) -> Tables:
    """Tables whose arrays are views of the packed numbers."""
    n, m, k, rank, alternatives, r = integers[0], integers[1], integers[2], integers[3], integers[4], integers[8]
    A, at = _take(numbers, 0, n, m)
    error_scale, at = _take(numbers, at, 1, n)
    particular, at = _take(numbers, at, m, n)
    kernel, at = _take(numbers, at, m, k)
    equations, at = _take(numbers, at, rank, m)
    unreachable, at = _take(numbers, at, n, n)
    plane, at = _take(numbers, at, m, 2)
    spread, at = _take(numbers, at, m, r)
    free, at = _take(numbers, at, m, m - r)
    basis, at = _take(numbers, at, n, r)
    gain, at = _take(numbers, at, r, m)
    wrench_weights, at = _take(numbers, at, 1, n)
    facets, at = _take(numbers, at, integers[6], r)
    weights, at = _take(numbers, at, 1, m)
    low, at = _take(numbers, at, m, 3)
    high, at = _take(numbers, at, m, 3)
    targets, at = _take(numbers, at, alternatives, m * 3)
    penalty, at = _take(numbers, at, m, 3)
    relaxed, at = _take(numbers, at, alternatives, m * 32)
    edge, at = _take(numbers, at, m, 3)
    return Tables(
        A, error_scale[0], WrenchFibre(particular, kernel, equations, unreachable, rank), plane, integers[5] != 0,
        WrenchDistance(spread, free, basis, gain, wrench_weights[0]), facets, integers[7] != 0, weights[0], low, high,
        integers[9:], targets.reshape(alternatives, m, 3), penalty, relaxed.reshape(alternatives, m, 8, 4), edge,
        numbers[at], numbers[at + 1], numbers[at + 2], numbers[at + 3], numbers[at + 4],
    )  # fmt: skip


@compiled
def _take(numbers: NDArray[np.float64], at: int, rows: int, columns: int) -> tuple[NDArray[np.float64], int]:
    end = at + rows * columns
    return numbers[at:end].reshape(rows, columns), end
