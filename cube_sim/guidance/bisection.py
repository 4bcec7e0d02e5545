"""Where a number lies among others that are in order, compiled."""

from __future__ import annotations

from cube_sim.native.compiled import compiled


@compiled
def count_up_to(edges, x):
    """How many of the edges (n,), in ascending order, are x or less: np.searchsorted(edges, x, side="right").

    numba's own is written for any kinds of numbers on either side, and takes ten times as long to compile.
    """
    low, high = 0, len(edges)
    while low < high:
        middle = (low + high) // 2
        if not edges[middle] > x:  # a NaN comes after all
            low = middle + 1
        else:
            high = middle
    return low
