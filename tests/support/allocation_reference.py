"""Slow, literal answers that share no code with the allocator."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import linprog, lsq_linear


def in_allowed_set(force: np.ndarray, limits: np.ndarray, allow_off: bool, tolerance: float = 0.0) -> np.ndarray:
    """(..., m) whether each force lies on one of its thruster's sides."""
    negative = (force >= limits[:, 0] - tolerance) & (force <= limits[:, 1] + tolerance)
    positive = (force >= limits[:, 2] - tolerance) & (force <= limits[:, 3] + tolerance)
    return negative | positive | (allow_off & (np.abs(force) <= tolerance))


def least_cost(A, limits, allow_off, wrench, *, target=None, weights=None, tolerance=1e-7):
    """Least ``sum w (f - t)^2`` over the union of all subsets and the forces of it, None when there are none.

    The optimum of a convex cell pins some thrusters at ends of their intervals and leaves the rest free. So every way
    of pinning up to dim ker A thrusters at any end of any side is tried, and the cheapest allowed one is the optimum:
    no convex solver, no bound, no pruning.
    """
    m = A.shape[1]
    t = np.zeros(m) if target is None else target
    root = np.sqrt(np.ones(m) if weights is None else weights)
    scaled = A / root
    _, sigma, Vt = np.linalg.svd(scaled)
    rank = int(np.sum(sigma > 1e-9 * sigma[0]))
    N = Vt[rank:].T
    g0 = np.linalg.pinv(scaled, rcond=1e-9) @ wrench
    if np.linalg.norm(scaled @ g0 - wrench) > 1e-6:
        return None
    free = N.T @ (root * t - g0)
    best = None
    for pins in range(m - rank + 1):
        for thrusters in map(list, itertools.combinations(range(m), pins)):
            rows = N[thrusters]
            if pins and np.linalg.matrix_rank(rows, tol=1e-9) < pins:
                continue
            ends = [sorted({*limits[i], 0.0} if allow_off else set(limits[i])) for i in thrusters]
            values = np.array(list(itertools.product(*ends))).reshape(-1, pins) if pins else np.zeros((1, 0))
            moved = (values * root[thrusters] - g0[thrusters] - rows @ free) @ np.linalg.pinv(rows).T if pins else 0.0
            f = np.atleast_2d(g0 + (free + moved) @ N.T) / root
            f = f[in_allowed_set(f, limits, allow_off, tolerance).all(axis=1)]
            if len(f):
                cost = (root**2 * (f - t) ** 2).sum(axis=1)
                at = int(np.argmin(cost))
                if best is None or cost[at] < best[0]:
                    best = float(cost[at]), f[at]
    return best


def cells(limits, allow_off):
    """(low, high) boxes of all 2^m or 3^m subsets."""
    sides = [[(a, b), (c, d)] + ([(0.0, 0.0)] if allow_off else []) for a, b, c, d in limits]
    for choice in itertools.product(*sides):
        yield np.array([low for low, _ in choice]), np.array([high for _, high in choice])


def least_distance(A, limits, allow_off, wrench, wrench_weights) -> float:
    """Least ``|W (A f - F)|`` over the union: one bounded least-squares problem (scipy) per subset."""
    M, goal = wrench_weights[:, None] * A, wrench_weights * wrench
    best = np.inf
    for low, high in cells(limits, allow_off):
        free = high > low
        fixed = np.where(free, 0.0, low)
        rest = goal - M @ fixed
        if free.any():
            solved = lsq_linear(M[:, free], rest, (low[free], high[free]), method="bvls", tol=1e-14, max_iter=500)
            best = min(best, np.sqrt(2.0 * solved.cost))
        else:
            best = min(best, np.linalg.norm(rest))
    return float(best)


def largest_share(A, limits, allow_off, primary, secondary):
    """Largest share in [0, 1] with ``primary + share * secondary`` attainable: one linear programme (HiGHS) per subset.

    None where there is no such share.
    """
    m = A.shape[1]
    best = None
    for low, high in cells(limits, allow_off):
        solved = linprog(
            np.append(np.zeros(m), -1.0),
            A_eq=np.column_stack([A, -secondary]),
            b_eq=primary,
            bounds=[*zip(low, high, strict=True), (0.0, 1.0)],
        )
        if solved.status == 0 and (best is None or solved.x[-1] > best):
            best = solved.x[-1]
    return best


def probing_wrenches(A, limits, allow_off, seed, count=30):
    """Wrenches of every kind: random small to saturating, single-axis, zero, and made by forces at interval ends."""
    n = len(A)
    rng = np.random.default_rng(seed)
    unit = np.abs(A) @ np.abs(limits).max(axis=1)
    yield np.zeros(n)
    for row in range(n):
        for part in (1e-4, 0.02, 0.1, 0.5):
            for sign in (1.0, -1.0):
                yield sign * part * unit[row] * np.eye(n)[row]
    for scale in (0.01, 0.1, 0.3):
        yield from scale * unit * rng.normal(size=(count, n))
    for _ in range(count):
        yield A @ [rng.choice([*row, 0.0] if allow_off else row) for row in limits]


def closest_forces(A, limits, allow_off, wrench, wrench_weights):
    """(s, m) forces of bounded least squares on every subset, and (s,) how much farther than the closest they end.

    In squared distances, by ``|a|^2 - |b|^2 = (a - b).(a + b)`` in extended precision: beside a component of 1e8 N the
    distances themselves would not show a difference of 1 N in another one.
    """
    W = np.asarray(wrench_weights)
    forces = []
    for low, high in cells(limits, allow_off):
        free, f = high > low, low.copy()
        if free.any():
            rest = W * (wrench - A[:, ~free] @ low[~free])
            f[free] = lsq_linear(W[:, None] * A[:, free], rest, (low[free], high[free]), method="bvls", tol=1e-15).x
        forces.append(f)
    forces = np.array(forces)
    A, W, f = (W[:, None] * A).astype(np.longdouble), (W * wrench).astype(np.longdouble), forces.astype(np.longdouble)
    farther = np.sum(((f - f[0]) @ A.T) * ((f + f[0]) @ A.T - 2 * W), axis=1)
    return forces, (farther - farther.min()).astype(float)
