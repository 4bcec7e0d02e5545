"""The exact search for the largest part of a wrench that keeps its direction and that allowed forces can make."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.search import MOST_NODES
from cube_sim.compiled import compiled


@compiled
def largest_scale(
    across: NDArray[np.float64],
    gain: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    relaxed: NDArray[np.float64],
    masks: NDArray[np.uint8],
    tolerance: float,
) -> tuple[float, bool, int]:
    """The largest scale in [0, 1] at which a demand is attainable, over the union of all subsets.

    The wrenches of a box of forces are ``lower <= normals @ w <= upper``, so the scales at which a box attains the
    demand are an interval, known in closed form. With dead zones the union of these intervals has gaps. Depth first
    over the motors: where a motor's side is open its box spans all open sides, which only widens the interval, and
    a node is discarded when the end of its interval does not exceed the best scale found.

    Args:
        across: (h,) the demand along each facet normal.
        gain: (h, m) what one newton of each motor makes along it.
        low: (m, 3) lower end of each side [N].
        high: (m, 3) upper end of each side [N].
        relaxed: (m, 8, 4) from `relax`: only the interval ends are used.
        masks: (m,) sides open to each motor at the root.
        tolerance: along a normal, that counts as rounding.

    Returns:
        The scale, negative when no part of the demand is attainable, not even none of it; whether that is proven;
        nodes looked at.
    """
    m = gain.shape[1]
    stack = np.empty((3 * m + 1, m), np.uint8)
    bound = np.empty(3 * m + 1)
    mask, child = np.empty(m, np.uint8), np.empty(m, np.uint8)
    sides, ends = np.empty(3, np.uint8), np.empty(3)
    for i in range(m):
        stack[0, i] = masks[i]
    bound[0] = interval_end(across, gain, relaxed, masks, tolerance)
    best, depth, looked = -1.0, 1, 1
    while depth > 0:
        depth -= 1
        if bound[depth] <= best:
            continue
        if looked >= MOST_NODES:
            return best, False, looked
        motor, widest = -1, -1.0
        for i in range(m):
            mask[i] = child[i] = stack[depth, i]
            if mask[i] & (mask[i] - 1):  # the longest stretch of forbidden force decides first
                gap = relaxed[i, mask[i], 1] - relaxed[i, mask[i], 0]
                for s in range(3):
                    if mask[i] >> s & 1:
                        gap -= high[i, s] - low[i, s]
                if gap > widest:
                    motor, widest = i, gap
        if motor < 0:
            best = bound[depth]
            if best >= 1.0:
                break
            continue
        count = 0
        for s in range(3):
            if mask[motor] >> s & 1:
                child[motor] = 1 << s
                end = interval_end(across, gain, relaxed, child, tolerance)
                looked += 1
                if end > best:
                    at = count
                    while at > 0 and ends[at - 1] > end:
                        ends[at], sides[at] = ends[at - 1], sides[at - 1]
                        at -= 1
                    ends[at], sides[at] = end, child[motor]
                    count += 1
        for c in range(count):  # the most promising last, to be looked at next
            for i in range(m):
                stack[depth, i] = mask[i]
            stack[depth, motor] = sides[c]
            bound[depth] = ends[c]
            depth += 1
    return best, True, looked


@compiled
def interval_end(
    across: NDArray[np.float64],
    gain: NDArray[np.float64],
    relaxed: NDArray[np.float64],
    mask: NDArray[np.uint8],
    tolerance: float,
) -> float:
    """Upper end of the scales in [0, 1] at which the box of each motor's open sides attains the demand; -1 for none."""
    first, last = 0.0, 1.0
    for a in range(gain.shape[0]):
        lower, upper = -tolerance, tolerance
        for i in range(gain.shape[1]):
            bottom, top = gain[a, i] * relaxed[i, mask[i], 0], gain[a, i] * relaxed[i, mask[i], 1]
            lower += min(bottom, top)
            upper += max(bottom, top)
        if abs(across[a]) <= 1e-300:
            if lower > 0.0 or upper < 0.0:
                return -1.0
        elif across[a] > 0.0:
            first, last = max(first, lower / across[a]), min(last, upper / across[a])
        else:
            first, last = max(first, upper / across[a]), min(last, lower / across[a])
        if not first <= last:
            return -1.0
    return last
