"""The actuation matrix A of F_B = A F_m, checked, and the length that makes torques comparable with forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import WrenchError
from cube_sim.wrench.arguments import bounded, numbers
from cube_sim.wrench.axes import Matrix, Vector, WrenchAxes, axes_of
from cube_sim.wrench.tolerances import SMALLEST

LARGEST_ERROR_N = 1e300
"""Components of a wrench error beyond this are all the same [N]; it keeps the size of the largest errors a number."""
LEAST_ARM_M = 1e-14
"""Lever arms below this are rounding of places in a vehicle [m]."""


def actuation_matrix(A: ArrayLike) -> tuple[Matrix, WrenchAxes]:
    """Check an actuation matrix and say how its rows are to be read.

    Args:
        A: (6,m) rows Fx Fy Fz Mx My Mz, or (3,m) rows Fx Fy Mz; F_B = A F_m. Entries are [1] and [m].

    Returns:
        A copy laid out in memory as A is, and the axes.

    Raises:
        WrenchError: another shape, no column, or a value that is not finite or too large for double precision.
    """
    matrix = numbers("the actuation matrix", A, "table", order="K")
    if matrix.ndim != 2 or matrix.shape[0] not in (3, 6):
        raise WrenchError(
            f"the actuation matrix has shape {matrix.shape}; it needs 6 rows (Fx Fy Fz Mx My Mz) or 3 (Fx Fy Mz) "
            "and one column per thruster"
        )
    if matrix.shape[1] == 0:
        raise WrenchError("the actuation matrix has no column: no thruster is left")
    if not np.all(np.isfinite(matrix)):
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise WrenchError(f"the actuation matrix has {matrix[row, column]} in row {row + 1}, column {column + 1}")
    bounded("the actuation matrix", matrix)
    return matrix, axes_of(len(matrix))


def effective_matrix(A: ArrayLike) -> Matrix:
    """Check an actuation matrix that forces are to be computed from: its thrusters must make some wrench.

    Args:
        A: as for `actuation_matrix`.

    Returns:
        A copy laid out row by row.

    Raises:
        WrenchError: as for `actuation_matrix`; or its entries are all zero, or too small for their squares.
    """
    matrix = np.ascontiguousarray(actuation_matrix(A)[0])
    if not np.any(matrix):
        raise WrenchError("the actuation matrix is zero: no thruster makes any wrench")
    largest = float(np.max(np.abs(matrix)))
    if largest < SMALLEST:
        raise WrenchError(
            f"the actuation matrix holds {largest:g} at most; below {SMALLEST:g} squares leave double precision"
        )
    return matrix


def lever_arm(A: Matrix, axes: WrenchAxes) -> float:
    """Root-mean-square lever arm of the thrusters [m]: torque per force over all columns of A; 1 where it is none."""
    force, torque = np.linalg.norm(A[: axes.forces]), np.linalg.norm(A[axes.forces :])
    # thrust through the origin leaves torques of rounding, and those are no measure
    return float(torque / force) if force > 0.0 and torque > LEAST_ARM_M * force else 1.0


def positive_length(length_m: float) -> float:
    """Return the length.

    Raises:
        WrenchError: it is not a positive finite number.
    """
    if not (np.isfinite(length_m) and length_m > 0.0):
        raise WrenchError(f"the torque length is {length_m} m; it must be positive")
    return float(length_m)


def error_size(error: Vector, length_m: float) -> float:
    """Norm of a wrench error [N], its torques divided by a length.

    Args:
        error: (n,) demanded minus achieved wrench [N], [N m]; components beyond `LARGEST_ERROR_N` count as that.
        length_m: what torques are divided by [m].
    """
    scaled = error.copy()
    with np.errstate(over="ignore"):
        scaled[axes_of(len(error)).torques] /= length_m
    scaled = np.clip(scaled, -LARGEST_ERROR_N, LARGEST_ERROR_N)
    largest = float(np.max(np.abs(scaled)))
    return largest * float(np.linalg.norm(scaled / largest)) if largest > 0.0 else 0.0
