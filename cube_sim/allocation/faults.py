"""Allowed forces of motors that are lost, weak or stuck."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cube_sim.allocation.arguments import row
from cube_sim.allocation.limits import NEGATIVE, OFF, POSITIVE, side_table
from cube_sim.errors import AllocationError


def faulty_sides(
    limits: NDArray[np.float64], allow_off: bool, efficiency: ArrayLike, stuck: Mapping[int, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sides of motors of which some do not work as built.

    Args:
        limits: (m, 4) of the motors as built [N].
        allow_off: whether a working motor may rest.
        efficiency: (m,) share of its force each motor still makes, 0 for a lost one, which rests in either set.
        stuck: motor, from 0, to the force it makes whatever it is told [N].

    Returns:
        low, high: (m, 3) as from `side_table`.

    Raises:
        AllocationError: an efficiency outside 0 to 1, no such motor, or a force that is not finite.
    """
    m = len(limits)
    share = row("efficiency", efficiency, m)
    if np.any(share < 0.0) or np.any(share > 1.0):
        raise AllocationError(f"efficiency is {share.tolist()}; every entry must lie in 0 to 1")
    low, high = side_table(limits * share[:, None] + 0.0, allow_off)
    for i in np.flatnonzero(share == 0.0):
        _only(low, high, int(i), 0.0)
    for i, force in stuck.items():
        if not 0 <= i < m:
            raise AllocationError(f"no motor {i} to be stuck; there are 0 to {m - 1}")
        _only(low, high, i, float(row("stuck", force, 1)[0]))
    return low, high


def _only(low: NDArray[np.float64], high: NDArray[np.float64], motor: int, force: float) -> None:
    """Leave a motor one force."""
    low[motor], high[motor] = np.inf, -np.inf
    side = OFF if force == 0.0 else POSITIVE if force > 0.0 else NEGATIVE
    low[motor, side] = high[motor, side] = force + 0.0
