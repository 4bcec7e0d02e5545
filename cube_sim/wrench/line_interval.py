"""Which part of a line of wrenches allowed forces attain, dead zones included: exact, by branch and bound.

The wrenches of a box of forces are bounded by the normals of the facets of {A F_m}, `lower <= normals . w <= upper`, so
the part of a line that a box attains is an interval in closed form. Allowed forces are a union of boxes, one for each
choice of an interval per thruster, up to 3^m of them: all are looked at, but those within a wider box that attains
nothing new are looked at together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.facets import facet_normals

MOST_WORK = 3e9
"""Boxes times facets after which a question is left unanswered: some seconds. Twelve thrusters take a thousandth."""
_INDEPENDENT = 1e-9
_ROUNDING = 1e-12


@dataclass(frozen=True)
class WrenchLine:
    """The wrenches t d that boxes of forces attain, in terms of facets.

    Attributes:
        along: (h,) normals . d; all zero where the thrusters attain d at t = 0 only.
        gain: (h,m) what one newton of each thruster makes along each normal.
        reach: largest |t| to look at: 0 where only t = 0 is attained, else infinite.
    """

    along: Vector
    gain: Matrix
    reach: float

    def box(self, allowed: AllowedForces) -> tuple[float, float]:
        """(lowest, highest) t over the box between the thrusters' most extreme forces, which holds 0."""
        if not self.reach or not len(self.along):
            return 0.0, 0.0
        ends = self.gain[:, :, None] * np.stack([allowed.minimum, allowed.maximum], axis=1)
        lower, upper = ends.min(axis=2).sum(axis=1), ends.max(axis=2).sum(axis=1)
        lower, upper = lower[self.along != 0.0], upper[self.along != 0.0]
        along = self.along[self.along != 0.0]
        first, last = np.where(along > 0.0, [lower, upper], [upper, lower]) / along
        return float(np.max(first)), float(np.min(last))

    def intervals(self, allowed: AllowedForces, join: float) -> Matrix | None:
        """(i,2) disjoint intervals of t that allowed forces attain, ascending, gaps up to `join` closed.

        None when it took more than `MOST_WORK`.
        """
        count = np.count_nonzero(~np.isnan(allowed.low), axis=1)
        gaps = np.nan_to_num(allowed.low[:, 1:] - allowed.high[:, :-1]).max(axis=1, initial=0.0)
        influence = np.linalg.norm(self.gain, axis=0)
        moves = np.flatnonzero(influence > 0.0)
        order = moves[np.argsort(-(gaps * influence)[moves], kind="stable")]
        scale = float(np.max(np.abs(self.gain) @ np.maximum(-allowed.minimum, allowed.maximum), initial=0.0))
        found, proven = attained(
            self.along,
            np.ascontiguousarray(self.gain[:, order].T),
            np.nan_to_num(allowed.low[order]),
            np.nan_to_num(allowed.high[order]),
            count[order],
            self.reach,
            _ROUNDING * scale,
            join,
        )
        return found if proven else None


@dataclass(frozen=True)
class WrenchSet:
    """All {A F_m}, ready to be asked about any line.

    Attributes:
        coordinates: (r,n) of a wrench in the basis in which A has orthonormal rows.
        basis: (n,r) orthonormal, of range(A).
        normals: (h,r) of the facets, in these coordinates.
        gain: (h,m) what one newton of each thruster makes along each normal.
    """

    coordinates: Matrix
    basis: Matrix
    normals: Matrix
    gain: Matrix

    @staticmethod
    def of(A: Matrix) -> WrenchSet:
        """Read it off A (n,m)."""
        U, sigma, Vt = np.linalg.svd(A, full_matrices=False)
        r = int(np.count_nonzero(sigma > _INDEPENDENT * max(sigma[0], np.finfo(float).tiny)))
        generators = Vt[:r]
        generators[:, ~np.any(A, axis=0)] = 0.0
        normals = facet_normals(generators) if r else np.zeros((0, 0))
        gain = normals @ generators if r else np.zeros((0, A.shape[1]))
        gain[np.abs(gain) < _ROUNDING] = 0.0
        return WrenchSet(U[:, :r].T / sigma[:r, None], U[:, :r], normals, gain)

    def line(self, direction: Vector) -> WrenchLine:
        """The wrenches t d, d (n,) not zero."""
        outside = direction - self.basis @ (self.basis.T @ direction)
        if np.linalg.norm(outside) > _INDEPENDENT * np.linalg.norm(direction):
            return WrenchLine(np.zeros(len(self.gain)), self.gain, 0.0)
        along = self.normals @ (self.coordinates @ direction)
        along[np.abs(along) < _INDEPENDENT * np.max(np.abs(along))] = 0.0
        return WrenchLine(along, self.gain, np.inf)


@compiled
def span(
    along: NDArray[np.float64],
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    reach: float,
    tolerance: float,
) -> tuple[float, float]:
    """Ends of the t in [-reach, reach] with `lower <= along t <= upper`; the first end lies above the last for none."""
    first, last = -reach, reach
    for a in range(along.shape[0]):
        bottom, top = lower[a] - tolerance, upper[a] + tolerance
        if along[a] == 0.0:
            if bottom > 0.0 or top < 0.0:
                return 1.0, 0.0
        elif along[a] > 0.0:
            first, last = max(first, bottom / along[a]), min(last, top / along[a])
        else:
            first, last = max(first, top / along[a]), min(last, bottom / along[a])
        if first > last:
            return 1.0, 0.0
    return first, last


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
    reach: float,
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
        reach: largest |t|.
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
    first, last = span(along, lower[0], upper[0], reach, tolerance)
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
                first, last = span(along, lower[depth + 1], upper[depth + 1], reach, tolerance)
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
