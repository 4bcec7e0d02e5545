"""What a thruster may still do when its side is undecided: an interval and a cost that never exceeds the true one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.sides import SideCost, SideIntervals
from cube_sim.native.compiled import compiled

ANY_SIDE = 7
"""Bit mask of the sides still open to a thruster: 1 negative, 2 off, 4 positive."""


@compiled
def relax(
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    target: NDArray[np.float64],
    penalty: NDArray[np.float64],
    weight: NDArray[np.float64],
    relaxed: NDArray[np.float64],
) -> None:
    """Tabulate, for every thruster and every mask of open sides, an interval and a quadratic below the true cost.

    On side s the true cost is ``w (f - target_s)^2 + penalty_s``. With t the mean target of the open sides,
    ``w (f - t)^2 + c`` stays below it when c is the least difference of the two; that difference is linear in f,
    so the ends of the intervals decide.

    Args:
        low: (m, 3) lower ends per side; an empty side has low > high.
        high: (m, 3) upper ends.
        target: (m, 3) preferred force per side [N].
        penalty: (m, 3) cost of choosing the side [N^2].
        weight: (m,) w.
        relaxed: (m, 8, 4) out: interval ends, t and c for each mask; an empty mask has low > high.
    """
    for i in range(low.shape[0]):
        for mask in range(8):
            bottom, top, total, count = math.inf, -math.inf, 0.0, 0
            for s in range(3):
                if mask >> s & 1 and low[i, s] <= high[i, s]:
                    bottom, top = min(bottom, low[i, s]), max(top, high[i, s])
                    total += target[i, s]
                    count += 1
            mean = total / count if count > 0 else 0.0
            constant = math.inf if count > 0 else 0.0
            for s in range(3):
                if mask >> s & 1 and low[i, s] <= high[i, s]:
                    t = target[i, s]
                    for end in (low[i, s], high[i, s]):
                        excess = penalty[i, s]
                        if t != mean:
                            excess += weight[i] * ((end - t) ** 2 - (end - mean) ** 2)
                        constant = min(constant, excess)
            relaxed[i, mask, 0], relaxed[i, mask, 1] = bottom, top
            relaxed[i, mask, 2], relaxed[i, mask, 3] = mean, constant


@compiled
def choose_side(
    f: float, i: int, mask: int, intervals: SideIntervals, side_cost: SideCost, tolerance: float
) -> tuple[int, float]:
    """The cheapest open side of thruster i whose interval holds force f, and its true cost; (-1, inf) in a dead zone.

    Where sides touch and cost the same, off wins, then the side of f's sign.
    """
    best, cost = -1, math.inf
    for order in range(3):
        s = 1 if order == 0 else (0 if (order == 1) == (f < 0.0) else 2)
        if mask >> s & 1 and intervals.low[i, s] - tolerance <= f <= intervals.high[i, s] + tolerance:
            value = side_cost.weight[i] * (f - side_cost.target[i, s]) ** 2 + side_cost.penalty[i, s]
            if value < cost:
                best, cost = s, value
    return best, cost


@compiled
def split(f: float, thruster: int, mask: int, intervals: SideIntervals) -> tuple[int, int]:
    """Divide the open sides of a thruster at force f, the part nearer to f first.

    A force in a gap divides the sides left of it from those right of it. A force inside a side divides that side from
    the others. Both parts are smaller than the mask.
    """
    below, above = 0, 0
    gap_below, gap_above = math.inf, math.inf
    nearest, distance = 0, math.inf
    for s in range(3):
        low, high = intervals.low[thruster, s], intervals.high[thruster, s]
        if mask >> s & 1 and low <= high:
            gap = max(low - f, f - high, 0.0)
            if gap < distance:
                nearest, distance = 1 << s, gap
            if high < f:
                below |= 1 << s
                gap_below = min(gap_below, gap)
            elif low > f:
                above |= 1 << s
                gap_above = min(gap_above, gap)
    if below and above and (below | above) == mask:
        return (below, above) if gap_below <= gap_above else (above, below)
    return nearest, mask & ~nearest


@compiled
def branch(
    stack: NDArray[np.int64],
    bound: NDArray[np.float64],
    depth: int,
    mask: NDArray[np.int64],
    thruster: int,
    parts: tuple[int, int],
    lower: float,
) -> int:
    """Put the nodes that leave one thruster a part of its sides on a stack, the last part on top; return its depth.

    Args:
        stack: (d, m) sides open to each thruster in each node to come, changed from ``depth`` on.
        bound: (d,) lower bounds of these nodes, likewise.
        depth: number of nodes on the stack.
        mask: (m,) of the node that is divided.
        thruster: that decides.
        parts: of its sides; an empty one makes no node.
        lower: bound of the node that is divided.
    """
    for part in parts:
        if part != 0:
            for i in range(mask.shape[0]):
                stack[depth, i] = mask[i]
            stack[depth, thruster] = part
            bound[depth] = lower
            depth += 1
    return depth
