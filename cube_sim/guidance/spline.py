"""A smooth curve through waypoints."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.guidance.corner import require_no_reversal
from cube_sim.guidance.tabulated import TabulatedPath
from cube_sim.guidance.tabulation import Piece, tabulate
from cube_sim.guidance.waypoints import as_waypoints

Array = NDArray[np.float64]


def spline(points: ArrayLike, closed: bool = False) -> TabulatedPath:
    """The cubic spline through the points with the distances between them as parameter.

    Its curvature is continuous, and zero at the ends of an open path (natural end conditions); its curvature rate jumps
    at the points.

    Args:
        points: (n, 3) [m], world axes.
        closed: whether it returns smoothly from the last point to the first.

    Raises:
        PathError: points coincide, the path doubles back at one, or the curve has a cusp.
    """
    knots = as_waypoints(points, closed)
    require_no_reversal(knots, closed)
    if closed:
        knots = np.vstack([knots, knots[:1]])
    steps = np.linalg.norm(np.diff(knots, axis=0), axis=1)
    slopes = np.diff(knots, axis=0) / steps[:, None]
    m = _tangents_closed(steps, slopes) if closed else _tangents_open(steps, slopes)
    pieces = [
        Piece(lambda u, h=h, a=m[i], b=m[i + 1], d=slopes[i]: _derivative(u / h, a, b, d), float(h), (i,))
        for i, h in enumerate(steps)
    ]
    return tabulate(knots[0], pieces, closed)


def _derivative(x: Array, a: Array, b: Array, d: Array) -> Array:
    """dp/du of the cubic with end derivatives a and b and mean slope d, at the share x of its span."""
    x = x[:, None]
    return a * (1.0 - x) * (1.0 - 3.0 * x) + b * x * (3.0 * x - 2.0) + d * 6.0 * x * (1.0 - x)


def _tangents_open(h: Array, d: Array) -> Array:
    """Derivatives (n, 3) at the knots that make the second one continuous, and zero at both ends."""
    lower = np.concatenate([[0.0], h[1:], [1.0]])
    upper = np.concatenate([[1.0], h[:-1], [0.0]])
    diagonal = np.concatenate([[2.0], 2.0 * (h[:-1] + h[1:]), [2.0]])
    inner = 3.0 * (h[1:, None] * d[:-1] + h[:-1, None] * d[1:])
    return _solve(lower, diagonal, upper, np.vstack([3.0 * d[:1], inner, 3.0 * d[-1:]]))


def _tangents_closed(h: Array, d: Array) -> Array:
    """Derivatives (n+1, 3), the last equal to the first, that make the second one continuous all round.

    The corners of the cyclic matrix are split off as a rank-one term (Sherman and Morrison 1950).
    """
    before = np.roll(h, 1)
    lower, upper, diagonal = h.copy(), before.copy(), 2.0 * (before + h)
    right = 3.0 * (h[:, None] * np.roll(d, 1, axis=0) + before[:, None] * d)
    corner_top, corner_bottom = lower[0], upper[-1]
    gamma = -diagonal[0]
    diagonal[0] -= gamma
    diagonal[-1] -= corner_top * corner_bottom / gamma
    lower[0] = upper[-1] = 0.0
    u = np.zeros(len(h))
    u[0], u[-1] = gamma, corner_bottom
    solved = _solve(lower, diagonal, upper, np.column_stack([right, u]))
    y, z = solved[:, :3], solved[:, 3]
    ratio = corner_top / gamma
    m = y - z[:, None] * ((y[0] + ratio * y[-1]) / (1.0 + z[0] + ratio * z[-1]))
    return np.vstack([m, m[:1]])


def _solve(lower: Array, diagonal: Array, upper: Array, right: Array) -> Array:
    """The tridiagonal system, diagonally dominant here, by elimination without pivots."""
    n = len(diagonal)
    factor, solution = np.empty(n), np.empty_like(right)
    factor[0], solution[0] = upper[0] / diagonal[0], right[0] / diagonal[0]
    for i in range(1, n):
        pivot = diagonal[i] - lower[i] * factor[i - 1]
        factor[i] = upper[i] / pivot
        solution[i] = (right[i] - lower[i] * solution[i - 1]) / pivot
    for i in range(n - 2, -1, -1):
        solution[i] -= factor[i] * solution[i + 1]
    return solution
