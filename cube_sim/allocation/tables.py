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
    """`Tables` and `Beyond` in two arrays: what a compiled call is handed costs time by the piece.

    Attributes:
        numbers: every float of both.
        integers: n, m, k, rank A, number of alternatives, planar, scaled, h, rank W A, where `Beyond` begins, then the
            masks of the m motors.
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


def pack(t: Tables, far: Beyond) -> Packed:
    """Put tables into two pieces, in the order `unpack` and `unpack_beyond` take them out."""
    fibre, distance = t.fibre, far.distance
    rows = t.error_scale, t.weights
    numbers = t.reversal_penalty, t.switching_penalty, t.change_limit, t.tolerance, t.reach
    matrices = t.A, fibre.particular, fibre.kernel, fibre.equations, fibre.unreachable, t.plane
    sides = t.low, t.high, t.penalty, t.edge, t.targets, t.relaxed
    last = distance.spread, distance.kernel, distance.basis, distance.gain, far.facets, distance.weights
    near = np.concatenate([np.ravel(part) for part in (*numbers, *rows, *matrices, *sides)])
    integers = (
        *t.A.shape, fibre.kernel.shape[1], fibre.rank, len(t.targets), t.planar, t.scaled, len(far.facets),
        len(distance.gain), len(near), *t.masks,
    )  # fmt: skip
    return Packed(np.concatenate([near, *map(np.ravel, last)]), np.array(integers, np.int64))


@compiled
def unpack(numbers: NDArray[np.float64], integers: NDArray[np.int64]) -> Tables:
    """Tables whose arrays are views of the packed numbers."""
    n, m, k, rank, alternatives = integers[0], integers[1], integers[2], integers[3], integers[4]
    at = 5 + n + m
    A, at = _take(numbers, at, n, m)
    particular, at = _take(numbers, at, m, n)
    kernel, at = _take(numbers, at, m, k)
    equations, at = _take(numbers, at, rank, m)
    unreachable, at = _take(numbers, at, n, n)
    plane, at = _take(numbers, at, m, 2)
    tables, at = _take(numbers, at, 4 * m, 3)
    targets = numbers[at : at + alternatives * m * 3].reshape(alternatives, m, 3)
    at += alternatives * m * 3
    relaxed = numbers[at : at + alternatives * m * 32].reshape(alternatives, m, 8, 4)
    return Tables(
        A, numbers[5 : 5 + n], WrenchFibre(particular, kernel, equations, unreachable, rank), plane, integers[5] != 0,
        integers[6] != 0, numbers[5 + n : 5 + n + m], tables[:m], tables[m : 2 * m], integers[10:], targets,
        tables[2 * m : 3 * m], relaxed, tables[3 * m :], float(numbers[0]), float(numbers[1]), float(numbers[2]),
        float(numbers[3]), float(numbers[4]),
    )  # fmt: skip


@compiled
def unpack_beyond(numbers: NDArray[np.float64], integers: NDArray[np.int64]) -> Beyond:
    """The rest of the packed numbers, as views."""
    n, m, h, r, at = integers[0], integers[1], integers[7], integers[8], integers[9]
    spread, at = _take(numbers, at, m, r)
    kernel, at = _take(numbers, at, m, m - r)
    basis, at = _take(numbers, at, n, r)
    gain, at = _take(numbers, at, r, m)
    facets, at = _take(numbers, at, h, r)
    return Beyond(WrenchDistance(spread, kernel, basis, gain, numbers[at : at + n]), facets)


@compiled
def _take(numbers: NDArray[np.float64], at: int, rows: int, columns: int) -> tuple[NDArray[np.float64], int]:
    end = at + rows * columns
    return numbers[at:end].reshape(rows, columns), end
