"""Whether a damping matrix takes energy out of the motion, as drag does."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from cube_sim.errors import ModelError
from cube_sim.spatial import Matrix

_AXES = ("x", "y", "z", "about x", "about y", "about z")
_ROUNDING = 1e-9


def require_dissipative(name: str, matrix: Matrix) -> None:
    """Refuse linear damping D with nu'D nu < 0 for some nu: the symmetric part must be positive semidefinite.

    The rest, (D - D')/2, does no work.

    Args:
        name: of the numeric, for the error.
        matrix: D (6,6).

    Raises:
        ModelError: it feeds energy in.
    """
    _require_diagonal(name, matrix)
    symmetric = 0.5 * (matrix + matrix.T)
    lowest = float(np.linalg.eigvalsh(symmetric)[0])
    if lowest < -_ROUNDING * np.abs(symmetric).max():
        raise ModelError(
            name,
            f"feeds energy into some motion: the lowest eigenvalue of its symmetric part is {lowest:g}; damping takes "
            "energy out (lift and other forces that do not: a force of your own)",
        )


def require_pairwise_dissipative(name: str, matrix: Matrix) -> None:
    """Refuse quadratic damping that feeds energy into a motion along, or about, one or two axes.

    Its power nu'D_q(|nu| nu) is a cubic form in every orthant. For two axes it is, up to a positive factor,
    a t^3 +- d t^2 +- c t + b, where t > 0 is the ratio of their speeds. That is checked exactly. Three and more axes
    moving together are left to the author: deciding those is a hard problem, and identified tables rarely meet it.

    Args:
        name: of the numeric, for the error.
        matrix: D_q (6,6).

    Raises:
        ModelError: it feeds energy in, with the two axes.
    """
    _require_diagonal(name, matrix)
    for i, j in combinations(range(6), 2):
        a, b, c, d = matrix[i, i], matrix[j, j], matrix[i, j], matrix[j, i]
        if any(_goes_negative(a, s * d, s * c, b) for s in (1.0, -1.0)):
            raise ModelError(
                name,
                f"feeds energy into motion {_AXES[i]} and {_AXES[j]} together: entries ({i + 1},{j + 1}) = {c:g} and "
                f"({j + 1},{i + 1}) = {d:g} are too large for the diagonal, {a:g} and {b:g}; damping takes energy out "
                "(lift and other forces that do not: a force of your own)",
            )


def _require_diagonal(name: str, matrix: Matrix) -> None:
    if np.any(np.diag(matrix) < 0.0):
        raise ModelError(name, "has a negative diagonal value; damping takes energy out")


def _goes_negative(a: float, d: float, c: float, b: float) -> bool:
    """Whether a t^3 + d t^2 + c t + b < 0 for some t > 0, with a, b >= 0."""
    if d >= 0.0 and c >= 0.0:
        return False
    # Speeds in units in which the diagonals are alike, so that rounding means the same for every vehicle.
    unit = (b / a) ** (1.0 / 3.0) if a > 0.0 and b > 0.0 else 1.0
    a, d, c = a * unit**3, d * unit**2, c * unit
    scale = max(a, abs(d), abs(c), b)
    if (a == 0.0 and d < 0.0) or (a == 0.0 and d == 0.0 and c < 0.0) or (b == 0.0 and c < 0.0):
        return True  # very fast, or very slow, along the one axis
    turning = np.roots([3.0 * a, 2.0 * d, c])
    lowest = [((a * t + d) * t + c) * t + b for t in turning.real[np.isreal(turning)] if t > 0.0]
    return min(lowest, default=0.0) < -_ROUNDING * scale
