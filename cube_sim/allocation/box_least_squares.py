"""The point of a box whose image is nearest to a target, by an active set, compiled.

The problem is small and strictly convex, so the answer is one, and the search for it ends: every round either fixes a
variable at a bound it runs into, or has reached the best of its free ones, and frees one that pulls away from its
bound.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from cube_sim.native.compiled import compiled

ROUNDS = 6
"""Rounds per variable after which the search ends with what it has (never seen)."""
PULLS = 1e-12
"""A slope below this share of the largest is none."""


@compiled
def nearest_in_box(C, target, price, low, high, x):
    """Minimise |C x - target|^2 + sum price_i x_i^2 over low <= x <= high.

    Args:
        C: (n,p).
        target: (n,).
        price: (p,) positive.
        low: (p,).
        high: (p,) not below `low`.
        x: (p,) where the search begins, and what it finds.
    """
    n, p = C.shape
    H, g = np.zeros((p, p)), np.zeros(p)
    for i in range(p):
        for a in range(n):
            g[i] += C[a, i] * target[a]
        for j in range(p):
            for a in range(n):
                H[i, j] += C[a, i] * C[a, j]
        H[i, i] += price[i]
    side = np.zeros(p)
    for i in range(p):
        x[i] = min(max(x[i], low[i]), high[i])
        if low[i] == high[i]:
            side[i] = 2.0
    best, L = np.zeros(p), np.zeros((p, p))
    for _ in range(ROUNDS * p):
        best_of_free(H, g, side, x, best, L)
        step, hit = 1.0, -1
        for i in range(p):
            if side[i] == 0.0:
                bound = high[i] if best[i] > high[i] else low[i]
                if (best[i] > high[i] or best[i] < low[i]) and (bound - x[i]) / (best[i] - x[i]) < step:
                    step, hit = (bound - x[i]) / (best[i] - x[i]), i
        for i in range(p):
            if side[i] == 0.0:
                x[i] += step * (best[i] - x[i])
        if hit >= 0:
            side[hit] = 1.0 if best[hit] > high[hit] else -1.0
            x[hit] = high[hit] if side[hit] > 0.0 else low[hit]
            continue
        most, away, largest = 0.0, -1, 0.0
        for i in range(p):
            pull = g[i]
            largest = max(largest, abs(g[i]))
            for j in range(p):
                pull -= H[i, j] * x[j]
            if abs(side[i]) == 1.0 and -side[i] * pull > most:
                most, away = -side[i] * pull, i
        if away < 0 or most <= PULLS * largest:
            return
        side[away] = 0.0


@compiled
def best_of_free(H, g, side, x, best, L):
    """The minimum of x' H x / 2 - g' x over those that are free (side 0), the others as they are, by Cholesky.

    Args:
        H: (p,p) positive definite.
        g: (p,).
        side: (p,) 0 of what is free.
        x: (p,).
        best: (p,) out.
        L: (p,p) scratch.
    """
    p = len(g)
    for i in range(p):
        best[i] = x[i]
        if side[i] != 0.0:
            continue
        rest = g[i]
        for j in range(p):
            if side[j] != 0.0:
                rest -= H[i, j] * x[j]
        for j in range(i + 1):
            if side[j] != 0.0:
                continue
            left = H[i, j]
            for k in range(j):
                if side[k] == 0.0:
                    left -= L[i, k] * L[j, k]
            L[i, j] = left / L[j, j] if j < i else sqrt(max(left, 1e-300))
        for k in range(i):
            if side[k] == 0.0:
                rest -= L[i, k] * best[k]
        best[i] = rest / L[i, i]
    for i in range(p - 1, -1, -1):
        if side[i] != 0.0:
            continue
        for k in range(i + 1, p):
            if side[k] == 0.0:
                best[i] -= L[k, i] * best[k]
        best[i] /= L[i, i]
