"""Which part of a line of wrenches allowed forces attain, dead zones included: exact, by branch and bound.

Allowed forces are a union of boxes, one for each choice of an interval per thruster, up to 3^m of them. All are looked
at, but those within a wider box that attains nothing new are looked at together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.wrench.line_interval import interval_in_box

MOST_WORK = 3e9
"""Boxes times facets after which a question is left unanswered: some seconds. Twelve thrusters take a thousandth."""


@compiled
def shift(
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    gain: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    count: NDArray[np.int64],
    depth: int,
    place: int,
) -> None:
    """Write the bounds of a node's child, whose thruster `depth` keeps to one interval, one level below the node's."""
    bottom, top = low[depth, 0], high[depth, count[depth] - 1]
    for a in range(gain.shape[1]):
        g = gain[depth, a]
        if g >= 0.0:
            lower[depth + 1, a] = lower[depth, a] + g * (low[depth, place] - bottom)
            upper[depth + 1, a] = upper[depth, a] + g * (high[depth, place] - top)
        else:
            lower[depth + 1, a] = lower[depth, a] + g * (high[depth, place] - top)
            upper[depth + 1, a] = upper[depth, a] + g * (low[depth, place] - bottom)


@compiled
def uncovered(union: NDArray[np.float64], size: int, first: float, last: float, join: float) -> float:
    """Length of [first, last] outside of the union of `size` disjoint intervals; -1 when it lies inside one of them."""
    length = last - first
    for i in range(size):
        if first >= union[i, 0] - join and last <= union[i, 1] + join:
            return -1.0
        length -= max(0.0, min(last, union[i, 1]) - max(first, union[i, 0]))
    return max(0.0, length)


@compiled
def united(
    union: NDArray[np.float64], size: int, first: float, last: float, join: float
) -> tuple[NDArray[np.float64], int]:
    """The union with [first, last], ascending, and its size; intervals at most `join` apart become one."""
    more = np.empty((max(16, 2 * (size + 1)), 2)) if size + 1 > union.shape[0] else union.copy()
    at = 0
    for i in range(size):
        if union[i, 1] + join < first:
            more[at, 0], more[at, 1] = union[i, 0], union[i, 1]
            at += 1
        elif union[i, 0] - join <= last:
            first, last = min(first, union[i, 0]), max(last, union[i, 1])
    more[at, 0], more[at, 1] = first, last
    at += 1
    for i in range(size):
        if union[i, 0] - join > last:
            more[at, 0], more[at, 1] = union[i, 0], union[i, 1]
            at += 1
    return more, at


@compiled
def attained(
    along: NDArray[np.float64],
    gain: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    count: NDArray[np.int64],
    farthest: float,
    tolerance: float,
    join: float,
) -> tuple[NDArray[np.float64], bool]:
    """The union of the intervals of all boxes.

    Depth first, one thruster decided per level, those not yet decided spanning all their intervals: that only widens
    a node's interval, so a node whose interval is attained already holds nothing new. The child that would add most
    comes first.

    Args:
        along: (h,) see `WrenchLine`.
        gain: (m,h) likewise, transposed, the thruster to decide first in front.
        low: (m,s) lower ends of the allowed intervals [N], ascending.
        high: (m,s) upper ends.
        count: (m,) how many of the s places are used.
        farthest: largest |t|.
        tolerance: along a normal, that counts as rounding.
        join: gap in t that counts as none.

    Returns:
        (i,2) disjoint intervals, ascending, and whether these are all.
    """
    m, h = gain.shape
    places = low.shape[1] if m > 0 else 0
    lower, upper = np.zeros((m + 1, h)), np.zeros((m + 1, h))
    for i in range(m):
        for a in range(h):
            x, y = gain[i, a] * low[i, 0], gain[i, a] * high[i, count[i] - 1]
            lower[0, a] += min(x, y)
            upper[0, a] += max(x, y)
    union, size, looked = np.empty((16, 2)), 0, 1
    first, last = interval_in_box(along, lower[0], upper[0], farthest, tolerance)
    if m == 0 and first <= last:
        union[0, 0], union[0, 1], size = first, last, 1
    child_first, child_last = np.empty((m, places)), np.empty((m, places))
    child, left = np.empty((m, places), np.int64), np.zeros(m, np.int64)
    news = np.empty(places)
    depth, entered = 0, m > 0 and first <= last
    while depth >= 0 and m > 0:
        if entered:  # look at all children
            left[depth] = 0
            for s in range(count[depth]):
                shift(lower, upper, gain, low, high, count, depth, s)
                first, last = interval_in_box(along, lower[depth + 1], upper[depth + 1], farthest, tolerance)
                looked += 1
                new = uncovered(union, size, first, last, join) if first <= last else -1.0
                if new < 0.0:
                    continue
                at = left[depth]
                while at > 0 and news[at - 1] > new:
                    news[at], child[depth, at] = news[at - 1], child[depth, at - 1]
                    child_first[depth, at], child_last[depth, at] = (
                        child_first[depth, at - 1],
                        child_last[depth, at - 1],
                    )
                    at -= 1
                news[at], child[depth, at] = new, s
                child_first[depth, at], child_last[depth, at] = first, last
                left[depth] += 1
            if looked * h > MOST_WORK:
                return union[:size].copy(), False
        entered = False
        if left[depth] == 0:
            depth -= 1
            continue
        left[depth] -= 1
        at = left[depth]
        first, last = child_first[depth, at], child_last[depth, at]
        if uncovered(union, size, first, last, join) < 0.0:
            continue
        shift(lower, upper, gain, low, high, count, depth, child[depth, at])
        if depth == m - 1:
            union, size = united(union, size, first, last, join)
            continue
        depth += 1
        entered = True
    return union[:size].copy(), True
