"""How much force and torque is attainable under the real limits, with and without dead zones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.actuation.allowed import AllowedForces
from cube_sim.actuation.basic_points import MOST_POINTS, BasicPoints, basic_points, candidates
from cube_sim.actuation.wrench_axes import Matrix, Vector, WrenchAxes, actuation_matrix
from cube_sim.actuation.zonotope import support
from cube_sim.errors import ActuationError

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Extent:
    """What is attainable of one wrench component (or along one direction).

    Attributes:
        name: the component.
        at_most: (lowest, highest) [N or N m] whatever the other components then are, dead zones left out.
        alone: (lowest, highest) with every other component exactly zero, dead zones left out.
        alone_with_dead_zones: (i,2) disjoint intervals of the values attainable with every other component exactly
            zero, ascending; rest is the interval [0, 0]. None with too many thrusters to enumerate.
    """

    name: str
    at_most: tuple[float, float]
    alone: tuple[float, float]
    alone_with_dead_zones: Matrix | None

    @property
    def finest(self) -> tuple[float, float] | None:
        """(reverse, forward) least attainable magnitudes apart from rest, alone and with dead zones [N or N m].

        0 where arbitrarily small values are attainable because thrusters run against each other outside their dead
        zones; infinite where nothing but rest is attainable; None when not enumerated.
        """
        if self.alone_with_dead_zones is None:
            return None
        return _least(-self.alone_with_dead_zones[::-1, ::-1]), _least(self.alone_with_dead_zones)


def extents(A: ArrayLike, limits: ArrayLike, *, rest: bool = True) -> tuple[Extent, ...]:
    """The extent of every wrench component.

    Args:
        A: (6,m) or (3,m).
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N], or (m,2), or one row.
        rest: whether a thruster may stand still inside its dead zone.

    Returns:
        n extents in the order of the rows of A.

    Raises:
        ActuationError: A or the limits are malformed.
    """
    matrix, axes = actuation_matrix(A)
    return tuple(
        extent(matrix, limits, direction, name=name, rest=rest)
        for name, direction in zip(axes.names, np.eye(len(matrix)), strict=True)
    )


def extent(A: ArrayLike, limits: ArrayLike, direction: ArrayLike, *, name: str = "", rest: bool = True) -> Extent:
    """The extent of the wrenches t d; values are t.

    Args:
        A: (6,m) or (3,m).
        limits: as in `extents`.
        direction: d (n,), not zero; [N, N m] per unit of t. `at_most` is the range of d . F_B / |d|^2.
        name: what to call it.
        rest: as in `extents`.

    Raises:
        ActuationError: A, the limits or the direction are malformed.
    """
    matrix, _ = actuation_matrix(A)
    d = np.asarray(direction, dtype=float)
    if d.shape != (len(matrix),) or not np.all(np.isfinite(d)) or not np.any(d):
        raise ActuationError(f"the direction {d.tolist()} must be {len(matrix)} finite numbers, not all zero")
    d = d / (d @ d)
    conditions = np.linalg.svd(d[None, :])[2][1:] @ matrix
    box = AllowedForces.from_limits(limits, matrix.shape[1], dead_zones=False)
    real = AllowedForces.from_limits(limits, matrix.shape[1], dead_zones=True, rest=rest)
    most = support(matrix, box.minimum, box.maximum, np.array([d, -d]))
    values = basic_points(conditions, box).forces @ (d @ matrix)
    round_off = _ROUNDING * max(1.0, float(np.max(most)))
    return Extent(
        name=name,
        at_most=(float(-most[1]), float(most[0])),
        alone=_clean(float(np.min(values)), float(np.max(values)), round_off),
        alone_with_dead_zones=_attainable(conditions, d @ matrix, real, round_off),
    )


def force_corners(A: ArrayLike, limits: ArrayLike) -> Matrix:
    """(p,forces) points [N] whose convex hull is the set of forces attainable with zero torque, dead zones left out."""
    matrix, axes = actuation_matrix(A)
    return _corners(matrix[: axes.forces], matrix[axes.forces :], limits, axes)


def torque_corners(A: ArrayLike, limits: ArrayLike) -> Matrix:
    """(p,n-forces) points [N m] whose hull is the set of torques attainable with zero force, dead zones left out."""
    matrix, axes = actuation_matrix(A)
    return _corners(matrix[axes.forces :], matrix[: axes.forces], limits, axes)


def _corners(wanted: Matrix, zero: Matrix, limits: ArrayLike, axes: WrenchAxes) -> Matrix:
    box = AllowedForces.from_limits(limits, wanted.shape[1], dead_zones=False)
    points = basic_points(zero, box).forces @ wanted.T
    scale = float(np.max(np.abs(points), initial=0.0))
    return np.unique(np.round(points, 9 - int(np.ceil(np.log10(max(scale, 1.0))))) + 0.0, axis=0)


def _attainable(conditions: Matrix, values: Vector, allowed: AllowedForces, round_off: float) -> Matrix | None:
    """Union of the intervals that values . F_m covers, one per cell, as disjoint intervals."""
    if candidates(conditions, allowed) > MOST_POINTS:
        return None
    points = basic_points(conditions, allowed)
    low, high = _per_cell(points, points.forces @ values)
    order = np.argsort(low, kind="stable")
    joined: list[tuple[float, float]] = []
    for a, b in zip(low[order].tolist(), high[order].tolist(), strict=True):
        if joined and a <= joined[-1][1] + round_off:
            joined[-1] = (joined[-1][0], max(joined[-1][1], b))
        else:
            joined.append((a, b))
    return np.array([_clean(a, b, round_off) for a, b in joined]).reshape(-1, 2)


def _per_cell(points: BasicPoints, t: Vector) -> tuple[Vector, Vector]:
    """Smallest and largest t over the corners of each cell."""
    if not len(t):
        return t, t
    places = points.cells.max() + 1
    codes: NDArray[np.int_] = points.cells @ places ** np.arange(points.cells.shape[1])
    _, cell = np.unique(codes, return_inverse=True)
    low, high = np.full(cell.max() + 1, np.inf), np.full(cell.max() + 1, -np.inf)
    np.minimum.at(low, cell, t)
    np.maximum.at(high, cell, t)
    return low, high


def _clean(low: float, high: float, round_off: float) -> tuple[float, float]:
    return (0.0 if abs(low) <= round_off else low, 0.0 if abs(high) <= round_off else high)


def _least(intervals: Matrix) -> float:
    """Infimum of the positive values in ascending disjoint intervals."""
    for low, high in intervals:
        if high > 0.0:
            return max(float(low), 0.0)
    return float("inf")
