"""All that a compiled call needs in one array: what it is handed costs time by the piece.

First `HEADER` integers: n, m, k, rank A, number of alternatives, planar, scaled, h, rank W A, and where
`ClosestWrenchData` and `Workspace` begin. Then `AllocationProblem`, `ClosestWrenchData`, `Workspace`, and
`PreviousAnswer` last. Integers lie in the bits of a float's place.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.problem import AllocationProblem, ClosestWrenchData
from cube_sim.allocation.exact.solutions import ForceSolutions, WrenchMetric
from cube_sim.allocation.exact.step import PreviousAnswer
from cube_sim.allocation.exact.workspace import Workspace, workspace_at, workspace_size
from cube_sim.native.compiled import compiled, cut

HEADER = 11


def pack(problem: AllocationProblem, closest: ClosestWrenchData, previous: NDArray[np.float64]) -> NDArray[np.float64]:
    """Put everything into one array, in the order the functions below take it out.

    Args:
        problem: of the vehicle.
        closest: of the vehicle.
        previous: (6, m), copied to the end.
    """
    p, solutions, metric = problem, problem.solutions, closest.metric
    n, m = p.A.shape
    numbers = (
        p.reversal_penalty,
        p.switching_penalty,
        p.dwell_calls,
        p.change_limit,
        p.tolerance,
        p.hidden,
        p.largest_wrench,
    )
    rows = p.error_scale, p.weights, p.masks.view(np.float64)
    matrices = p.A, solutions.particular, solutions.null_space, solutions.equations, solutions.outside_range, p.plane
    sides = p.low, p.high, p.penalty, p.edge, p.targets, p.relaxed
    first = np.concatenate([np.ravel(part) for part in (*numbers, *rows, *matrices, *sides)])
    matrices = metric.G_pinv, metric.null_space, metric.basis, metric.G, closest.facets, metric.weights
    second = np.concatenate([np.ravel(part) for part in matrices])
    begins = HEADER + len(first), HEADER + len(first) + len(second)
    sizes = n, m, solutions.null_space.shape[1], solutions.rank, len(p.targets)
    header = np.array((*sizes, p.planar, p.scaled, len(closest.facets), len(metric.G), *begins), np.int64)
    return np.concatenate([header.view(np.float64), first, second, np.zeros(workspace_size(n, m)), previous.ravel()])


@compiled
def unpack(packed: NDArray[np.float64]) -> AllocationProblem:
    """The problem, its arrays as views of the packed numbers."""
    header, real = cut(packed, 0, (HEADER,), np.int64), np.float64
    n, m, k, rank, alternatives = header[0], header[1], header[2], header[3], header[4]
    numbers = cut(packed, HEADER, (7,), real)
    error_scale = HEADER + 7
    weights = error_scale + n
    masks = weights + m
    A = masks + m
    particular = A + n * m
    null_space = particular + n * m
    equations = null_space + m * k
    outside_range = equations + rank * m
    plane = outside_range + n * n
    low = plane + 2 * m
    targets = low + 12 * m
    side = (m, 3)
    return AllocationProblem(
        cut(packed, A, (n, m), real),
        cut(packed, error_scale, (n,), real),
        ForceSolutions(
            cut(packed, particular, (m, n), real),
            cut(packed, null_space, (m, k), real),
            cut(packed, equations, (rank, m), real),
            cut(packed, outside_range, (n, n), real),
            rank,
        ),
        cut(packed, plane, (m, 2), real),
        header[5] != 0,
        header[6] != 0,
        cut(packed, weights, (m,), real),
        cut(packed, low, side, real),
        cut(packed, low + 3 * m, side, real),
        cut(packed, masks, (m,), np.int64),
        cut(packed, targets, (alternatives, m, 3), real),
        cut(packed, low + 6 * m, side, real),
        cut(packed, targets + alternatives * m * 3, (alternatives, m, 8, 4), real),
        cut(packed, low + 9 * m, side, real),
        numbers[0],
        numbers[1],
        numbers[2],
        numbers[3],
        numbers[4],
        numbers[5],
        numbers[6],
    )


@compiled
def unpack_closest_wrench_data(packed: NDArray[np.float64]) -> ClosestWrenchData:
    """What an unattainable wrench needs besides, as views."""
    header, real = cut(packed, 0, (HEADER,), np.int64), np.float64
    n, m, h, r, G_pinv = header[0], header[1], header[7], header[8], header[9]
    null_space = G_pinv + m * r
    basis = null_space + m * (m - r)
    G = basis + n * r
    facets = G + r * m
    return ClosestWrenchData(
        WrenchMetric(
            cut(packed, G_pinv, (m, r), real),
            cut(packed, null_space, (m, m - r), real),
            cut(packed, basis, (n, r), real),
            cut(packed, G, (r, m), real),
            cut(packed, facets + h * r, (n,), real),
        ),
        cut(packed, facets, (h, r), real),
    )


@compiled
def unpack_workspace(packed: NDArray[np.float64]) -> Workspace:
    """The scratch rows, as views."""
    header = cut(packed, 0, (HEADER,), np.int64)
    return workspace_at(packed, header[10], header[0], header[1])


@compiled
def unpack_previous_answer(packed: NDArray[np.float64]) -> PreviousAnswer:
    """The previous answer, as views."""
    m = cut(packed, 1, (1,), np.int64)[0]
    at = packed.shape[0] - 6 * m
    return PreviousAnswer(
        cut(packed, at, (m,), np.float64),
        cut(packed, at + m, (m,), np.float64),
        cut(packed, at + 2 * m, (m,), np.float64),
        cut(packed, at + 3 * m, (m,), np.float64),
        cut(packed, at + 4 * m, (m,), np.float64),
        cut(packed, at + 5 * m, (m,), np.float64),
    )


@compiled
def answer_rows(packed: NDArray[np.float64]) -> NDArray[np.float64]:
    """(6, m) the previous answer as one view."""
    m = cut(packed, 1, (1,), np.int64)[0]
    return cut(packed, packed.shape[0] - 6 * m, (6, m), np.float64)


@compiled
def set_reach(packed: NDArray[np.float64], reach: float) -> None:
    """Let every force change by so much in the next call [N], either way."""
    rows = answer_rows(packed)
    for i in range(rows.shape[1]):
        rows[4, i] = rows[5, i] = reach


def previous_answer_rows(packed: NDArray[np.float64], m: int) -> NDArray[np.float64]:
    """(6, m) the same as one view, for Python."""
    return packed[-6 * m :].reshape(6, m)
