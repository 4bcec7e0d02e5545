"""Which wrenches are attainable at all: whole maps at once, from the half-spaces that bound each subset's wrenches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.exact.solutions import force_solutions
from cube_sim.allocation.subset_qp.enumeration import every_subset
from cube_sim.errors import AllocationError
from cube_sim.native.compiled import compiled
from cube_sim.wrench.arguments import numbers
from cube_sim.wrench.axes import axes_of
from cube_sim.wrench.facets import facet_normals
from cube_sim.wrench.limits import side_table, thruster_limits
from cube_sim.wrench.line_interval import narrowed
from cube_sim.wrench.matrix import effective_matrix, lever_arm
from cube_sim.wrench.tolerances import NO_SLOPE


class HalfSpaces(NamedTuple):
    """Wrench w is attainable with a subset if and only if ``low <= normals @ w <= high`` in that subset's row.

    Attributes:
        normals: (h, n) the same for all subsets.
        low: (s, h) per subset.
        high: (s, h).
        subsets: (s, m) int8 sides, -1, 0, +1.
    """

    normals: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    subsets: NDArray[np.int8]


def half_spaces(A: ArrayLike, limits: ArrayLike, *, allow_off: bool = True) -> HalfSpaces:
    """The sets ``A K`` of all boxes K as half-spaces, bounded across `facet_normals`.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        allow_off: see `Allocator`.
    """
    matrix = effective_matrix(A)
    m = matrix.shape[1]
    solutions = force_solutions(matrix, np.ones(m), lever_arm(matrix, axes_of(len(matrix))))
    columns = solutions.equations  # (r, m) the columns of A in coordinates of range(A)
    normals = facet_normals(columns)
    low, high = side_table(thruster_limits(limits, m), allow_off)
    subsets = every_subset(low, high)
    gain = normals @ columns  # (h, m) what one newton of each thruster makes along each normal
    least, most = np.zeros((len(subsets), len(normals))), np.zeros((len(subsets), len(normals)))
    for i in range(m):
        at = subsets[:, i] + 1
        ends = np.outer(low[i, at], gain[:, i]), np.outer(high[i, at], gain[:, i])
        least += np.minimum(*ends)
        most += np.maximum(*ends)
    outside = solutions.outside_range[np.linalg.norm(solutions.outside_range, axis=1) > 1e-12]
    none = np.zeros((len(subsets), len(outside)))
    return HalfSpaces(
        np.vstack([normals @ columns @ solutions.particular, outside]),
        np.hstack([least, none]),
        np.hstack([most, none]),
        subsets,
    )


def attainable_map(
    A: ArrayLike,
    limits: ArrayLike,
    centre: ArrayLike,
    across: ArrayLike,
    down: ArrayLike,
    shape: tuple[int, int] = (512, 512),
    *,
    allow_off: bool = True,
) -> NDArray[np.bool_]:
    """Which wrenches of a rectangle in wrench space are attainable, exactly over the union of all subsets.

    Args:
        A: see `Allocator`.
        limits: see `Allocator`.
        centre: (n,) wrench in the middle of the map [N, N m].
        across: (n,) from the middle to the right edge.
        down: (n,) from the middle to the bottom edge.
        shape: rows and columns.
        allow_off: see `Allocator`.

    Returns:
        (rows, columns) True where attainable; the outermost entries lie on the edges.

    Raises:
        AllocationError: a vector of another size, or an empty map.
    """
    spaces = half_spaces(A, limits, allow_off=allow_off)
    n = spaces.normals.shape[1]
    names = "centre", "across", "down"
    vectors = [numbers(name, v, "vector") for name, v in zip(names, (centre, across, down), strict=True)]
    for name, vector in zip(names, vectors, strict=True):
        if vector.shape != (n,) or not np.all(np.isfinite(vector)):
            raise AllocationError(f"{name} must be {n} finite numbers")
    if min(shape) < 1:
        raise AllocationError(f"the map has shape {shape}; it needs a row and a column at least")
    largest = float(np.max(np.abs(np.asarray(limits, dtype=np.float64))))
    middle, right, bottom = (spaces.normals @ vector for vector in vectors)
    found = np.zeros(shape, np.bool_)
    _fill(middle, right, bottom, spaces.low, spaces.high, 1e-8 * largest, found)
    return found


@compiled
def _fill(
    middle: NDArray[np.float64],
    right: NDArray[np.float64],
    bottom: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    tolerance: float,
    found: NDArray[np.bool_],
) -> None:
    """Mark what the subsets attain: each cuts one interval out of each row of the map.

    Args:
        middle: (h,) the half-spaces' normals times the map's centre.
        right: (h,) times its vector across.
        bottom: (h,) times its vector down.
        low: (s, h) see `HalfSpaces`.
        high: (s, h).
        tolerance: that counts as rounding.
        found: (rows, columns) marked True.
    """
    rows, columns = found.shape
    half = max(0.5 * (columns - 1), 0.5)
    centre = 0.5 * (columns - 1)
    for row in range(rows):
        v = 0.0 if rows == 1 else 2.0 * row / (rows - 1) - 1.0
        for s in range(low.shape[0]):
            first, last = -1.0, 1.0
            for h in range(middle.shape[0]):
                at = middle[h] + v * bottom[h]
                below, above = low[s, h] - tolerance - at, high[s, h] + tolerance - at
                slope = right[h] if abs(right[h]) > NO_SLOPE else 0.0
                first, last = narrowed(first, last, below, above, slope)
                if first > last:
                    break
            if first <= last:
                begin = int(np.ceil(centre + half * first - 1e-9))
                end = int(np.floor(centre + half * last + 1e-9))
                for column in range(max(begin, 0), min(end, columns - 1) + 1):
                    found[row, column] = True
