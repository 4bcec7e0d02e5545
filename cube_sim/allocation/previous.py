"""Where motors stand between two control periods: what an allocator built anew goes on from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Standing(NamedTuple):
    """The last answer for m motors.

    Attributes:
        force: (m,) [N].
        subset: (m,) the side each motor is on: -1, 0, +1.
        push: (m,) direction each motor last pushed to, rests passed over; 0 if it never has.
    """

    force: NDArray[np.float64]
    subset: NDArray[np.float64]
    push: NDArray[np.float64]

    @staticmethod
    def at_rest(m: int) -> Standing:
        """As at the start of a run."""
        return Standing(np.zeros(m), np.zeros(m), np.zeros(m))

    def then(self, force: NDArray[np.float64], subset: NDArray[np.number]) -> Standing:
        """The standing after forces (m,) on sides (m,)."""
        return Standing(force.copy(), subset.astype(np.float64), np.where(subset != 0, subset, self.push))

    def of(self, motors: NDArray[np.int_]) -> Standing:
        """The standing of some motors (k,), numbered from 0."""
        return Standing(self.force[motors], self.subset[motors], self.push[motors])
