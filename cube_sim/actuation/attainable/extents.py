"""How much force and torque is attainable under the real limits, with and without dead zones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.actuation.attainable.basic_points import basic_points
from cube_sim.errors import ActuationError
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import Matrix, Vector, WrenchAxes
from cube_sim.wrench.matrix import actuation_matrix
from cube_sim.wrench.wrench_set import WrenchSet
from cube_sim.wrench.zonotope import support

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Extent:
    """What is attainable of one wrench component (or along one direction).

    Attributes:
        name: the component.
        unconstrained: (lowest, highest) [N or N m] whatever the other components then are, dead zones left out.
        isolated: (lowest, highest) [N or N m] with every other component exactly zero, dead zones left out.
        isolated_with_dead_zones: (i,2) [N or N m] disjoint intervals of the values attainable with every other
            component exactly zero, ascending; rest is the interval [0, 0]. None where that takes too long
            (`cube_sim.wrench.attained_intervals.MOST_WORK`).
    """

    name: str
    unconstrained: tuple[float, float]
    isolated: tuple[float, float]
    isolated_with_dead_zones: Matrix | None

    @property
    def smallest_nonzero(self) -> tuple[float, float] | None:
        """(reverse, forward) least attainable magnitudes apart from rest, isolated, with dead zones [N or N m].

        0 where arbitrarily small values are attainable because thrusters run against each other outside their dead
        zones; infinite where nothing but rest is attainable; None when not computed.
        """
        if self.isolated_with_dead_zones is None:
            return None
        return _least(-self.isolated_with_dead_zones[::-1, ::-1]), _least(self.isolated_with_dead_zones)


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
    layout = _ExtentsOfOneLayout(matrix, limits, rest)
    return tuple(
        layout.extent(direction, name) for name, direction in zip(axes.names, np.eye(len(matrix)), strict=True)
    )


def extent(A: ArrayLike, limits: ArrayLike, direction: ArrayLike, *, name: str = "", rest: bool = True) -> Extent:
    """The extent of the wrenches t d; values are t.

    Args:
        A: (6,m) or (3,m).
        limits: as in `extents`.
        direction: d (n,), not zero; [N, N m] per unit of t. `Extent.unconstrained` is the range of d . F_B / |d|^2.
        name: what to call it.
        rest: as in `extents`.

    Raises:
        ActuationError: A, the limits or the direction are malformed.
    """
    matrix, _ = actuation_matrix(A)
    d = np.asarray(direction, dtype=float)
    if d.shape != (len(matrix),) or not np.all(np.isfinite(d)) or not np.any(d):
        raise ActuationError(f"the direction {d.tolist()} must be {len(matrix)} finite numbers, not all zero")
    return _ExtentsOfOneLayout(matrix, limits, rest).extent(d, name)


class _ExtentsOfOneLayout:
    """What extents along different directions have in common."""

    def __init__(self, A: Matrix, limits: ArrayLike, rest: bool) -> None:
        self._A, self._set = A, WrenchSet.of(A)
        self._box = AllowedForces.from_limits(limits, A.shape[1], dead_zones=False)
        self._real = AllowedForces.from_limits(limits, A.shape[1], dead_zones=True, rest=rest)

    def extent(self, d: Vector, name: str) -> Extent:
        """See `extent`."""
        unit = d / (d @ d)
        most = support(self._A, self._box.minimum, self._box.maximum, np.array([unit, -unit]))
        round_off = _ROUNDING * max(1.0, float(np.max(most)))
        line = self._set.line(d)
        found = line.intervals(self._real, round_off)
        return Extent(
            name=name,
            unconstrained=(float(-most[1]), float(most[0])),
            isolated=_clean(*line.box(self._box), round_off),
            isolated_with_dead_zones=None if found is None else _all_clean(found, round_off),
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
    points = basic_points(zero, box.minimum, box.maximum) @ wanted.T
    scale = float(np.max(np.abs(points), initial=0.0))
    return np.unique(np.round(points, 9 - int(np.ceil(np.log10(max(scale, 1.0))))) + 0.0, axis=0)


def _clean(low: float, high: float, round_off: float) -> tuple[float, float]:
    return (0.0 if abs(low) <= round_off else low, 0.0 if abs(high) <= round_off else high)


def _all_clean(intervals: Matrix, round_off: float) -> Matrix:
    return np.array([_clean(low, high, round_off) for low, high in intervals.tolist()]).reshape(-1, 2)


def _least(intervals: Matrix) -> float:
    """Infimum of the positive values in ascending disjoint intervals."""
    for low, high in intervals:
        if high > 0.0:
            return max(float(low), 0.0)
    return float("inf")
