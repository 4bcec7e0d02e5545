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
    """`Tables` in three arrays: what a compiled call is handed costs time by the piece.

    Attributes:
        numbers: every float of the tables, field after field.
        sizes: n, m, k, r, number of alternatives, planar, h.
        masks: (m,) as in `Tables`.
    """

    numbers: NDArray[np.float64]
    sizes: NDArray[np.int64]
    masks: NDArray[np.uint8]


class Tables(NamedTuple):
    """One vehicle, one objective.

    Attributes:
        A: (n, m) actuation matrix.
        error_scale: (n,) 1 for forces, 1/length for torques.
        particular: (m, n) see `WrenchFibre`.
        kernel: (m, k) see `WrenchFibre`.
        equations: (r, m) see `WrenchFibre`.
        unreachable: (n, n) see `WrenchFibre`.
        plane: (m, 2) the kernel with columns of zeros for missing dimensions, for `line_search`.
        planar: whether `line_search` may be used.
        spread: (m, r) see `WrenchDistance`.
        free: (m, k) its orthonormal kernel.
        basis: (n, r) see `WrenchDistance`.
        gain: (r, m) see `WrenchDistance`.
        facets: (h, r) normals across which a demand is scaled, in the coordinates s of `WrenchDistance`; h = 0 where
            the closest wrench is wanted instead.
        wrench_weights: (n,) diagonal of W.
        weights: (m,) w.
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
        masks: (m,) bits of the sides that are not empty.
        targets: (t, m, 3) alternatives of the objective [N].
        penalty: (m, 3) zeros.
        relaxed: (t, m, 8, 4) from `relax` without penalties.
        edge: (m, 3) force at which a motor enters each side [N], from where changes are counted.
        reversal_penalty: price of one motor changing its direction of push [N^2].
        change_limit: most a motor's force may change in one call, dead zone not counted [N]; infinite for no limit.
        tolerance: force that counts as rounding [N].
        reach: largest force or torque the vehicle can make along one axis [N], [N m].
    """

    A: NDArray[np.float64]
    error_scale: NDArray[np.float64]
    particular: NDArray[np.float64]
    kernel: NDArray[np.float64]
    equations: NDArray[np.float64]
    unreachable: NDArray[np.float64]
    plane: NDArray[np.float64]
    planar: bool
    spread: NDArray[np.float64]
    free: NDArray[np.float64]
    basis: NDArray[np.float64]
    gain: NDArray[np.float64]
    facets: NDArray[np.float64]
    wrench_weights: NDArray[np.float64]
    weights: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    masks: NDArray[np.uint8]
    targets: NDArray[np.float64]
    penalty: NDArray[np.float64]
    relaxed: NDArray[np.float64]
    edge: NDArray[np.float64]
    reversal_penalty: float
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
    change_limit: float,
    tolerance: float,
    length_m: float,
    scaled: bool,
) -> Tables:
    """Tabulate; see `Tables` for the arguments."""
    n, m = A.shape
    plane = np.zeros((m, 2))
    if fibre.kernel.shape[1] <= 2:
        plane[:, : fibre.kernel.shape[1]] = fibre.kernel
    error_scale = np.ones(n)
    error_scale[torque_rows(n)] = 1.0 / length_m
    relaxed = np.empty((len(targets), m, 8, 4))
    uniform = bool(np.all(targets == targets[:, :, :1]))
    tables = Tables(
        A=A,
        error_scale=error_scale,
        particular=fibre.particular,
        kernel=fibre.kernel,
        equations=fibre.equations,
        unreachable=fibre.unreachable,
        plane=plane,
        planar=bool(uniform and fibre.kernel.shape[1] <= 2 and suits_lines(plane)),
        spread=distance.spread,
        free=distance.kernel,
        basis=distance.basis,
        gain=distance.gain,
        facets=facet_normals(distance.gain) if scaled else np.zeros((0, len(distance.gain))),
        wrench_weights=distance.weights,
        weights=weights,
        low=sides[0],
        high=sides[1],
        masks=np.zeros(m, np.uint8),
        targets=np.ascontiguousarray(targets),
        penalty=np.zeros((m, 3)),
        relaxed=relaxed,
        edge=np.zeros((m, 3)),
        reversal_penalty=reversal_penalty,
        change_limit=change_limit,
        tolerance=tolerance,
        reach=0.0,
    )
    return with_sides(tables, *sides)


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
        masks=(open_side * (1, 2, 4)).sum(axis=1).astype(np.uint8),
        penalty=penalty,
        relaxed=relaxed,
        edge=np.ascontiguousarray(
            np.column_stack(
                [np.where(open_side[:, 0], high[:, 0], 0.0), np.zeros(m), np.where(open_side[:, 2], low[:, 2], 0.0)]
            )
        ),
        reach=float(np.max(np.abs(tables.A) @ strongest)),
    )


def pack(tables: Tables) -> Packed:
    """Put tables into one piece, in the order `unpack` takes them out."""
    fields = [np.ravel(field) for name, field in tables._asdict().items() if name not in ("masks", "planar")]
    n, m = tables.A.shape
    k, r = tables.kernel.shape[1], len(tables.equations)
    sizes = np.array([n, m, k, r, len(tables.targets), tables.planar, len(tables.facets)], np.int64)
    return Packed(np.concatenate(fields), sizes, tables.masks)


@compiled
def unpack(packed: Packed) -> Tables:
    """Tables whose arrays are views of the packed numbers."""
    numbers, sizes, masks = packed
    n, m, k, r, alternatives = sizes[0], sizes[1], sizes[2], sizes[3], sizes[4]
    A, at = _take(numbers, 0, n, m)
    error_scale, at = _take(numbers, at, 1, n)
    particular, at = _take(numbers, at, m, n)
    kernel, at = _take(numbers, at, m, k)
    equations, at = _take(numbers, at, r, m)
    unreachable, at = _take(numbers, at, n, n)
    plane, at = _take(numbers, at, m, 2)
    spread, at = _take(numbers, at, m, r)
    free, at = _take(numbers, at, m, m - r)
    basis, at = _take(numbers, at, n, r)
    gain, at = _take(numbers, at, r, m)
    facets, at = _take(numbers, at, sizes[6], r)
    wrench_weights, at = _take(numbers, at, 1, n)
    weights, at = _take(numbers, at, 1, m)
    low, at = _take(numbers, at, m, 3)
    high, at = _take(numbers, at, m, 3)
    targets, at = _take(numbers, at, alternatives, m * 3)
    penalty, at = _take(numbers, at, m, 3)
    relaxed, at = _take(numbers, at, alternatives, m * 32)
    edge, at = _take(numbers, at, m, 3)
    return Tables(
        A, error_scale[0], particular, kernel, equations, unreachable, plane, sizes[5] != 0, spread, free, basis, gain,
        facets, wrench_weights[0], weights[0], low, high, masks, targets.reshape(alternatives, m, 3), penalty,
        relaxed.reshape(alternatives, m, 8, 4), edge, float(numbers[at]), float(numbers[at + 1]),
        float(numbers[at + 2]), float(numbers[at + 3]),
    )  # fmt: skip


@compiled
def _take(numbers: NDArray[np.float64], at: int, rows: int, columns: int) -> tuple[NDArray[np.float64], int]:
    end = at + rows * columns
    return numbers[at:end].reshape(rows, columns), end
