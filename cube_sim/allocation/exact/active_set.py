"""The closest point of a stack of strips: the one small convex problem every exact search is made of."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.wrench.tolerances import NO_NEW_DIRECTION

OPTIMAL, INFEASIBLE, CUT, STALLED = 0, 1, 2, 3
"""Outcomes: solved; no point satisfies the strips; the distance exceeds the cutoff; the iteration limit was hit."""


@compiled
def scratch(k: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Memory for projections in k coordinates: two pieces cost less time than eight."""
    return np.empty((2 * k + 5, k)), np.empty(k, np.int64)


@compiled
def project_within(
    rows: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    start: NDArray[np.float64],
    cutoff: float,
    tolerance: float,
    point: NDArray[np.float64],
    multiplier: NDArray[np.float64],
    work: NDArray[np.float64],
    active: NDArray[np.int64],
) -> int:
    """`project` in memory of `scratch`, which many projections share: asking for it takes as long as a small one."""
    m, k = rows.shape
    Q = work[:k]  # orthonormal basis of the active normals, one per row
    R = work[k : 2 * k]  # R[j, a]: coordinate a of active normal j in Q
    side, u, r, step, coordinate = work[2 * k], work[2 * k + 1], work[2 * k + 2], work[2 * k + 3], work[2 * k + 4]
    count = 0
    for a in range(k):
        point[a] = start[a]
    for i in range(m):
        multiplier[i] = 0.0

    for _ in range(20 * (m + 1)):
        worst, added, sign, end = tolerance, -1, 1.0, 0.0
        for i in range(m):
            value = 0.0
            for a in range(k):
                value += rows[i, a] * point[a]
            if low[i] - value > worst:
                worst, added, sign, end = low[i] - value, i, 1.0, low[i]
            if value - high[i] > worst:
                worst, added, sign, end = value - high[i], i, -1.0, -high[i]
        if added < 0:
            for j in range(count):
                multiplier[active[j]] -= side[j] * u[j]
            return OPTIMAL
        norm = 0.0
        for a in range(k):
            norm += rows[added, a] * rows[added, a]
        norm = math.sqrt(norm)
        if norm <= 1e-14:
            return INFEASIBLE
        u_added = 0.0
        while True:
            # The new normal splits into a part inside the active span (coordinate) and one orthogonal to it (step).
            for a in range(k):
                step[a] = sign * rows[added, a]
            for j in range(count):
                coordinate[j] = 0.0
            for _pass in range(2):  # the second pass removes what rounding left
                for j in range(count):
                    dot = 0.0
                    for a in range(k):
                        dot += Q[j, a] * step[a]
                    coordinate[j] += dot
                    for a in range(k):
                        step[a] -= dot * Q[j, a]
            square = 0.0
            for a in range(k):
                square += step[a] * step[a]
            for j in range(count - 1, -1, -1):
                value = coordinate[j]
                for c in range(j + 1, count):
                    value -= R[c, j] * r[c]
                r[j] = value / R[j, j]
            partial, dropped = math.inf, -1
            for j in range(count):
                if r[j] > 1e-12 * norm and u[j] / r[j] < partial:
                    partial, dropped = u[j] / r[j], j
            independent = count < k and square > (NO_NEW_DIRECTION * norm) ** 2
            full = math.inf
            if independent:
                slack = -end
                for a in range(k):
                    slack += sign * rows[added, a] * point[a]
                full = max(0.0, -slack / square)
            length = min(partial, full)
            if length == math.inf:
                return INFEASIBLE
            for j in range(count):
                u[j] -= length * r[j]
            u_added += length
            if independent:
                distance = 0.0
                for a in range(k):
                    point[a] += length * step[a]
                    distance += (point[a] - start[a]) ** 2
                if distance > cutoff:
                    return CUT
            if full <= partial:
                norm_step = math.sqrt(square)
                for j in range(count):
                    R[count, j] = coordinate[j]
                R[count, count] = norm_step
                for a in range(k):
                    Q[count, a] = step[a] / norm_step
                active[count], side[count], u[count] = added, sign, u_added
                count += 1
                break
            if dropped < 0:  # not a number: the data overflowed
                return STALLED
            count = _drop(rows, active, side, u, Q, R, dropped, count)
    return STALLED


@compiled
def project(
    rows: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    start: NDArray[np.float64],
    cutoff: float,
    tolerance: float,
    point: NDArray[np.float64],
    multiplier: NDArray[np.float64],
) -> int:
    """Project ``start`` onto ``{x : low <= rows @ x <= high}`` by a dual active-set method.

    Minimises ``|x - start|^2 / 2``. The method starts at the unconstrained minimum and adds the most violated
    strip until none is left, so that the distance only grows: it may stop as soon as it exceeds ``cutoff``, and
    what it returns is the exact projection up to rounding, with its multipliers.
    Goldfarb & Idnani, Math. Programming 27 (1983), with the unit matrix as Hessian.

    Args:
        rows: (m, k).
        low: (m,) lower ends, in the unit of ``rows @ x``.
        high: (m,) upper ends.
        start: (k,) the point to project.
        cutoff: squared distance above which the answer does not matter.
        tolerance: violation of a strip that counts as none.
        point: (k,) out: the projection.
        multiplier: (m,) out: its multipliers, negative at a lower end, positive at an upper end, such that
            ``point - start + rows.T @ multiplier = 0``.

    Returns:
        OPTIMAL, INFEASIBLE, CUT or STALLED.
    """
    work, active = scratch(rows.shape[1])
    return project_within(rows, low, high, start, cutoff, tolerance, point, multiplier, work, active)


@compiled
def _drop(
    rows: NDArray[np.float64],
    active: NDArray[np.int64],
    side: NDArray[np.float64],
    u: NDArray[np.float64],
    Q: NDArray[np.float64],
    R: NDArray[np.float64],
    dropped: int,
    count: int,
) -> int:
    """Remove one active strip and rebuild the basis from that place on; at these sizes cheaper than rotating it."""
    k = rows.shape[1]
    for j in range(dropped, count - 1):
        active[j], side[j], u[j] = active[j + 1], side[j + 1], u[j + 1]
        for a in range(k):
            Q[j, a] = side[j] * rows[active[j], a]
        for c in range(j):
            R[j, c] = 0.0
        for _pass in range(2):
            for c in range(j):
                dot = 0.0
                for a in range(k):
                    dot += Q[c, a] * Q[j, a]
                R[j, c] += dot
                for a in range(k):
                    Q[j, a] -= dot * Q[c, a]
        square = 0.0
        for a in range(k):
            square += Q[j, a] * Q[j, a]
        R[j, j] = math.sqrt(square)
        for a in range(k):
            Q[j, a] /= R[j, j]
    return count - 1
