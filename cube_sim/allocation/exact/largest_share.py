"""The exact search along a line of wrenches: the largest share of the way that allowed forces can make."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.branch_and_bound import MOST_NODES
from cube_sim.allocation.exact.sides import SideIntervals
from cube_sim.native.compiled import compiled
from cube_sim.wrench.line_interval import narrowed
from cube_sim.wrench.tolerances import NO_SLOPE


@compiled
def largest_share(
    base: NDArray[np.float64],
    across: NDArray[np.float64],
    gain: NDArray[np.float64],
    intervals: SideIntervals,
    tolerance: float,
) -> tuple[float, bool, int]:
    """The largest share in [0, 1] at which ``primary + share * secondary`` is attainable, over all subsets.

    The wrenches of a box of forces are ``lower <= normals @ w <= upper``. The shares at which a box attains the demand
    are therefore an interval, known in closed form. With dead zones the union of these intervals has gaps::

        one box        |----------------|
        another                                 |------|
        share       ---+----------------+-------+------+---->  largest: the end of the rightmost one
                       0                               1

    The search goes depth first over the thrusters. While a thruster's side is undecided its box spans all open sides,
    which only widens the interval. A node is left when the end of its interval does not exceed the best share found.

    Args:
        base: (h,) the primary wrench along each facet normal.
        across: (h,) the secondary wrench along each.
        gain: (h, m) what one newton of each thruster makes along it.
        intervals: open to the thrusters; of ``relaxed`` only the interval ends are used.
        tolerance: along a normal, that counts as rounding.

    Returns:
        The share, negative when none is attainable, not even 0; whether that is proven; nodes looked at.
    """
    m = gain.shape[1]
    relaxed = intervals.relaxed
    stack = np.empty((3 * m + 1, m), np.int64)
    bound = np.empty(3 * m + 1)
    mask, child = np.empty(m, np.int64), np.empty(m, np.int64)
    order, ends = np.empty(3, np.int64), np.empty(3)
    for i in range(m):
        stack[0, i] = child[i] = intervals.masks[i]
    best, depth, looked = -1.0, 1, 1
    bound[0] = interval_end(base, across, gain, relaxed, child, tolerance)
    while depth > 0:
        depth -= 1
        if bound[depth] <= best:
            continue
        if looked >= MOST_NODES:
            return best, False, looked
        thruster, widest = -1, -1.0
        for i in range(m):
            mask[i] = child[i] = stack[depth, i]
            if mask[i] & (mask[i] - 1):  # the longest stretch of forbidden force decides first
                gap = relaxed[i, mask[i], 1] - relaxed[i, mask[i], 0]
                for s in range(3):
                    if mask[i] >> s & 1:
                        gap -= intervals.high[i, s] - intervals.low[i, s]
                if gap > widest:
                    thruster, widest = i, gap
        if thruster < 0:
            best = bound[depth]
            if best >= 1.0:
                break
            continue
        count = 0
        for s in range(3):
            if mask[thruster] >> s & 1:
                child[thruster] = 1 << s
                end = interval_end(base, across, gain, relaxed, child, tolerance)
                looked += 1
                if end > best:
                    at = count
                    while at > 0 and ends[at - 1] > end:
                        ends[at], order[at] = ends[at - 1], order[at - 1]
                        at -= 1
                    ends[at], order[at] = end, child[thruster]
                    count += 1
        for c in range(count):  # the most promising last, to be looked at next
            for i in range(m):
                stack[depth, i] = mask[i]
            stack[depth, thruster] = order[c]
            bound[depth] = ends[c]
            depth += 1
    return best, True, looked


@compiled
def interval_end(
    base: NDArray[np.float64],
    across: NDArray[np.float64],
    gain: NDArray[np.float64],
    relaxed: NDArray[np.float64],
    mask: NDArray[np.int64],
    tolerance: float,
) -> float:
    """Upper end of the shares in [0, 1] at which the box of all open sides attains the demand; -1 for none."""
    first, last = 0.0, 1.0
    for a in range(gain.shape[0]):
        lower, upper = -tolerance, tolerance
        for i in range(gain.shape[1]):
            bottom, top = gain[a, i] * relaxed[i, mask[i], 0], gain[a, i] * relaxed[i, mask[i], 1]
            lower += min(bottom, top)
            upper += max(bottom, top)
        lower, upper = lower - base[a], upper - base[a]
        slope = across[a] if abs(across[a]) > NO_SLOPE else 0.0
        first, last = narrowed(first, last, lower, upper, slope)
        if not first <= last:
            return -1.0
    return last
