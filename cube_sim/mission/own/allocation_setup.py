"""What an allocator of the user's own gets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.spatial import Matrix


@dataclass(frozen=True)
class AllocationSetup:
    """What an allocator of one's own is made from, whenever other thrusters respond.

    Attributes:
        A: (6,k) [1, m] of the thrusters that respond, as the controller believes.
        limits: (k,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N]; those of a weak thruster are narrower.
        which: (k,) their numbers, from 0.
        names: (k,) their names.
        allow_off: whether a thruster may rest at 0 N, inside its dead zone.
    """

    A: Matrix
    limits: Matrix
    which: NDArray[np.int_]
    names: tuple[str, ...]
    allow_off: bool
