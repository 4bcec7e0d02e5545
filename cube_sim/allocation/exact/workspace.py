"""Where compiled calls work: arrays kept from call to call, since asking for them takes longer than using them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled, cut


class Workspace(NamedTuple):
    """Scratch rows; what they hold means nothing from one call to the next.

    Attributes:
        wrenches: (4, n).
        thrusters: (7, m).
        planes: (10, m) for `planar_search`.
        lines: (5, 6 m) for `planar_search`: two ends of three sides of each thruster.
        counts: (4, 6 m) for `planar_search`.
    """

    wrenches: NDArray[np.float64]
    thrusters: NDArray[np.float64]
    planes: NDArray[np.float64]
    lines: NDArray[np.float64]
    counts: NDArray[np.int64]


def workspace_size(n: int, m: int) -> int:
    """Numbers in the workspace of an (n, m) vehicle."""
    return 4 * n + (7 + 10 + 5 * 6 + 4 * 6) * m


@compiled
def workspace_at(packed: NDArray[np.float64], at: int, n: int, m: int) -> Workspace:
    """Name the parts of a workspace that begins at a place."""
    thrusters = at + 4 * n
    planes, lines, counts = thrusters + 7 * m, thrusters + 17 * m, thrusters + 47 * m
    return Workspace(
        cut(packed, at, (4, n), np.float64),
        cut(packed, thrusters, (7, m), np.float64),
        cut(packed, planes, (10, m), np.float64),
        cut(packed, lines, (5, 6 * m), np.float64),
        cut(packed, counts, (4, 6 * m), np.int64),
    )
