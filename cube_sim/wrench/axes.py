"""The components of a wrench: their names, their words, and the length that makes torques comparable with forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import ActuationError

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class WrenchAxes:
    """How the n components of a wrench are to be read.

    Attributes:
        names: (n,) component names.
        abilities: (n,) what a vehicle does with each of them, as the words after "can" or "cannot".
        forces: number of leading components that are forces [N]; the others are torques [N m].
        rows: (n,) which of the six components they are.
    """

    names: tuple[str, ...]
    abilities: tuple[str, ...]
    forces: int
    rows: tuple[int, ...]

    def scale(self, length_m: float) -> Vector:
        """(n,) diagonal of W: W F_B has every component in newtons."""
        return np.array([1.0] * self.forces + [1.0 / length_m] * (len(self.names) - self.forces))


PLANAR = WrenchAxes(
    names=("Fx", "Fy", "Mz"),
    abilities=("push forwards or back", "push sideways", "turn (yaw)"),
    forces=2,
    rows=(0, 1, 5),
)
SPATIAL = WrenchAxes(
    names=("Fx", "Fy", "Fz", "Mx", "My", "Mz"),
    abilities=("push forwards or back", "push sideways", "push up or down", "roll", "pitch", "turn (yaw)"),
    forces=3,
    rows=(0, 1, 2, 3, 4, 5),
)


def actuation_matrix(A: ArrayLike) -> tuple[Matrix, WrenchAxes]:
    """Check an actuation matrix and say how its rows are to be read.

    Args:
        A: (6,m) rows Fx Fy Fz Mx My Mz, or (3,m) rows Fx Fy Mz; F_B = A F_m.

    Raises:
        ActuationError: another shape, no column, or a value that is not finite.
    """
    try:
        matrix = np.array(A, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ActuationError(f"the actuation matrix is not a table of numbers: {error}") from None
    if matrix.ndim != 2 or matrix.shape[0] not in (3, 6):
        raise ActuationError(
            f"the actuation matrix has shape {matrix.shape}; it needs 6 rows (Fx Fy Fz Mx My Mz) or 3 (Fx Fy Mz) "
            "and one column per thruster"
        )
    if matrix.shape[1] == 0:
        raise ActuationError("the actuation matrix has no column: no thruster is left")
    if not np.all(np.isfinite(matrix)):
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise ActuationError(f"the actuation matrix has {matrix[row, column]} in row {row + 1}, column {column + 1}")
    return matrix, SPATIAL if len(matrix) == 6 else PLANAR


def lever_arm(A: Matrix, axes: WrenchAxes) -> float:
    """Root-mean-square lever arm of the thrusters [m]: torque per force over all columns of A; 1 when undefined."""
    force, torque = np.linalg.norm(A[: axes.forces]), np.linalg.norm(A[axes.forces :])
    return float(torque / force) if force > 0.0 and torque > 0.0 else 1.0


def positive_length(length_m: float) -> float:
    """Return the length.

    Raises:
        ActuationError: it is not a positive finite number.
    """
    if not (np.isfinite(length_m) and length_m > 0.0):
        raise ActuationError(f"the torque length is {length_m} m; it must be positive")
    return float(length_m)
