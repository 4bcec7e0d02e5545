"""What a motor may still do when its side is undecided: an interval and a cost that never exceeds the true one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.sides import Price, Sides
from cube_sim.native.compiled import compiled

ANY_SIDE = 7
"""Bit mask of the sides still open to a motor: 1 negative, 2 off, 4 positive."""


@compiled
def relax(
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    target: NDArray[np.float64],
    penalty: NDArray[np.float64],
    weight: NDArray[np.float64],
    relaxed: NDArray[np.float64],
) -> None:
    """Tabulate, for every motor and every mask of open sides, an interval and a quadratic below the true cost.

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
            bottom, top, total, sides = math.inf, -math.inf, 0.0, 0
            for s in range(3):
                if mask >> s & 1 and low[i, s] <= high[i, s]:
                    bottom, top = min(bottom, low[i, s]), max(top, high[i, s])
                    total += target[i, s]
                    sides += 1
            mean = total / sides if sides > 0 else 0.0
            constant = math.inf if sides > 0 else 0.0
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
def choose_side(f: float, motor: int, mask: int, sides: Sides, price: Price, tolerance: float) -> tuple[int, float]:
    """The cheapest open side whose interval holds force f, and its true cost; (-1, inf) in a dead zone.

    Where sides touch and cost the same, off wins, then the side of f's sign.
    """
    best, cost = -1, math.inf
    for order in range(3):
        s = 1 if order == 0 else (0 if (order == 1) == (f < 0.0) else 2)
        if mask >> s & 1 and sides.low[motor, s] - tolerance <= f <= sides.high[motor, s] + tolerance:
            value = price.weight[motor] * (f - price.target[motor, s]) ** 2 + price.penalty[motor, s]
            if value < cost:
                best, cost = s, value
    return best, cost


@compiled
def split(f: float, motor: int, mask: int, sides: Sides) -> tuple[int, int]:
    """Divide the open sides of a motor at force f, the part nearer to f first; both parts are smaller than the mask.

    A force in a gap divides the sides left of it from those right of it; a force inside a side divides that side
    from the others.
    """
    below, above = 0, 0
    gap_below, gap_above = math.inf, math.inf
    nearest, distance = 0, math.inf
    for s in range(3):
        low, high = sides.low[motor, s], sides.high[motor, s]
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
    motor: int,
    parts: tuple[int, int],
    lower: float,
) -> int:
    """Put the nodes that leave one motor a part of its sides on a stack, the last part on top; returns its new depth.

    Args:
        stack: (d, m) sides open to each motor in each node to come, changed from ``depth`` on.
        bound: (d,) lower bounds of these nodes, likewise.
        depth: number of nodes on the stack.
        mask: (m,) of the node that is divided.
        motor: that decides.
        parts: of its sides; an empty one makes no node.
        lower: bound of the node that is divided.
    """
    for part in parts:
        if part != 0:
            for i in range(mask.shape[0]):
                stack[depth, i] = mask[i]
            stack[depth, motor] = part
            bound[depth] = lower
            depth += 1
    return depth
