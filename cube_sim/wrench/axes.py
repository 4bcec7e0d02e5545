"""The components of a wrench: their names, their words, and which of them are torques."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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

    @property
    def torques(self) -> slice:
        """Where the torques are among the n components."""
        return slice(self.forces, len(self.names))

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


def axes_of(rows: int) -> WrenchAxes:
    """The axes of a wrench of 3 rows (Fx Fy Mz) or 6 (Fx Fy Fz Mx My Mz)."""
    return PLANAR if rows == len(PLANAR.names) else SPATIAL
