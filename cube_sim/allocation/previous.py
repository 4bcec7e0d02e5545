"""The forces of the previous answer: what an allocator built anew goes on from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class PreviousForces(NamedTuple):
    """The last answer for m thrusters.

    Attributes:
        force: (m,) [N].
        subset: (m,) the side each thruster is on: -1, 0, +1.
        push: (m,) direction each thruster last pushed to, rests passed over; 0 if it never has.
    """

    force: NDArray[np.float64]
    subset: NDArray[np.float64]
    push: NDArray[np.float64]

    @staticmethod
    def at_rest(m: int) -> PreviousForces:
        """As at the start of a run."""
        return PreviousForces(np.zeros(m), np.zeros(m), np.zeros(m))

    def followed_by(self, force: NDArray[np.float64], subset: NDArray[np.number]) -> PreviousForces:
        """The same after an answer with forces (m,) [N] on sides (m,)."""
        return PreviousForces(force.copy(), subset.astype(np.float64), np.where(subset != 0, subset, self.push))

    def of(self, thrusters: NDArray[np.int_]) -> PreviousForces:
        """Those of some thrusters (k,), numbered from 0."""
        return PreviousForces(self.force[thrusters], self.subset[thrusters], self.push[thrusters])
