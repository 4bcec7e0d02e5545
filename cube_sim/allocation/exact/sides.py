"""What a thruster may do on each side and what it costs there, in the form every search takes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class SideIntervals(NamedTuple):
    """The intervals each thruster may work in, one for each side: negative, off, positive.

    Attributes:
        low: (m, 3) lower end of each side [N]; an empty side has low > high.
        high: (m, 3) upper end of each side [N].
        masks: (m,) bits of the sides that are not empty: 1 negative, 2 off, 4 positive.
        relaxed: (m, 8, 4) from `relax`.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    masks: NDArray[np.int64]
    relaxed: NDArray[np.float64]


class SideCost(NamedTuple):
    """The cost of a thruster's force f on side s: ``weight (f - target[s])^2 + penalty[s]`` [N^2].

    Attributes:
        weight: (m,) w > 0.
        target: (m, 3) preferred force on each side [N].
        penalty: (m, 3) cost of choosing each side [N^2], >= 0.
    """

    weight: NDArray[np.float64]
    target: NDArray[np.float64]
    penalty: NDArray[np.float64]
