"""Where compiled calls work: memory kept from call to call, since asking for it takes longer than using it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled, cut


class Room(NamedTuple):
    """Rows to work in; what they hold means nothing from one call to the next.

    Attributes:
        wrenches: (4, n).
        motors: (7, m).
        planes: (10, m) for `line_search`.
        lines: (5, 6 m) for `line_search`: two ends of three sides of each motor.
        counts: (4, 6 m) for `line_search`.
    """

    wrenches: NDArray[np.float64]
    motors: NDArray[np.float64]
    planes: NDArray[np.float64]
    lines: NDArray[np.float64]
    counts: NDArray[np.int64]


def room_size(n: int, m: int) -> int:
    """Numbers in the room of an (n, m) vehicle."""
    return 4 * n + (7 + 10 + 5 * 6 + 4 * 6) * m


@compiled
def room_at(packed: NDArray[np.float64], at: int, n: int, m: int) -> Room:
    """Name the parts of a room that begins at a place."""
    motors = at + 4 * n
    planes, lines, counts = motors + 7 * m, motors + 17 * m, motors + 47 * m
    return Room(
        cut(packed, at, (4, n), np.float64),
        cut(packed, motors, (7, m), np.float64),
        cut(packed, planes, (10, m), np.float64),
        cut(packed, lines, (5, 6 * m), np.float64),
        cut(packed, counts, (4, 6 * m), np.int64),
    )
