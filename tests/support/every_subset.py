"""Lawson and Hanson's least-distance programming on every subset: the least cost of making a wrench."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import nnls
from scipy.spatial import ConvexHull


def wrench_half_spaces(A):
    """Normals (h, n) of the facets of ``{A f : |f_i| <= 1}``, by Qhull, and (c, n) of the space it lies in.

    A box of other sizes has the same facets, or fewer.
    """
    U, sigma, _ = np.linalg.svd(A)
    rank = int(np.sum(sigma > 1e-9 * sigma[0]))
    inside, outside = U[:, :rank] / sigma[:rank], U[:, rank:]  # the coordinates Qhull sees are all of a size
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=A.shape[1]))) @ (inside.T @ A).T
    if rank == 1:
        return inside.T / np.linalg.norm(inside), outside.T
    normals = ConvexHull(corners).equations[:, :-1] @ inside.T
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    normals *= np.sign(normals[np.arange(len(normals)), np.argmax(np.abs(normals) > 1e-6, axis=1)])[:, None]
    return np.unique(normals.round(13), axis=0), outside.T


class EverySubset:
    """Lawson and Hanson's least-distance programming on every subset whose wrenches include the demanded one."""

    def __init__(self, A, limits, allow_off, weights):
        self.A, self.limits, self.weights = A, limits, weights
        table = np.stack([limits[:, [0, 1]], np.zeros((len(limits), 2)), limits[:, [2, 3]]], axis=1)
        thrusters = np.arange(len(limits))
        self.subsets = np.array(list(itertools.product((-1, 0, 1) if allow_off else (-1, 1), repeat=len(limits))))
        self.low = table[thrusters, self.subsets + 1, 0]
        self.high = table[thrusters, self.subsets + 1, 1]
        self.normals, self.outside = wrench_half_spaces(A)
        reach = self.normals @ A  # (h, m) what one newton of each thruster makes across each facet
        middle, half = 0.5 * (self.low + self.high) @ reach.T, 0.5 * (self.high - self.low) @ np.abs(reach).T
        self.least, self.most = middle - half, middle + half
        self.root = np.sqrt(weights)
        self.N = kernel_of(A / self.root)
        self.pinv = np.linalg.pinv(A / self.root, rcond=1e-9)

    def live(self, wrench, tolerance):
        if np.any(np.abs(self.outside @ wrench) > 1e-6):
            return np.array([], int)
        value = self.normals @ wrench
        return np.flatnonzero(((value >= self.least - tolerance) & (value <= self.most + tolerance)).all(axis=1))

    def cheapest(self, wrench, side_target, penalty, tolerance):
        """Least cost over all subsets; side_target and penalty are (m, 3)."""
        g0 = self.pinv @ wrench
        best = np.inf
        thrusters = np.arange(len(self.limits))
        for s in self.live(wrench, tolerance):
            at = thrusters, self.subsets[s] + 1
            t, price = side_target[at], penalty[at].sum()
            centre = g0 + self.N @ (self.N.T @ (self.root * t - g0))
            fixed = float(np.sum((centre - self.root * t) ** 2)) + price
            if fixed >= best:
                continue
            y = least_move(self.N, self.root * self.low[s] - centre, self.root * self.high[s] - centre, tolerance)
            if y is not None:
                best = min(best, fixed + float(y @ y))
        return best


def kernel_of(matrix):
    """(m, k) orthonormal basis of what a matrix (r, m) takes to zero."""
    _, sigma, Vt = np.linalg.svd(matrix)
    return Vt[int(np.sum(sigma > 1e-9 * sigma.max(initial=0.0))) :].T


def least_move(N, low, high, tolerance):
    """The shortest y with ``low <= N y <= high`` but for the tolerance, None when there is none.

    Lawson & Hanson 1974, chapter 23. With its multipliers u >= 0, ``y = G' u`` and every other such y' has
    ``y.y' = u.G y' >= u.h``: it cannot be shorter than y by more than is asserted.
    """
    G, h = np.vstack([N, -N]), np.concatenate([low, -high]) - tolerance
    if np.all(h <= 0.0):
        return np.zeros(N.shape[1])
    if not N.shape[1]:
        return None
    E, e = np.vstack([G.T, h]), np.append(np.zeros(N.shape[1]), 1.0)
    u, residual = nnls(E, e, maxiter=1000)
    r = E @ u - e
    if residual <= 1e-11 or r[-1] == 0.0:
        return None
    y, u = -r[:-1] / r[-1], -u / r[-1]
    if np.any(G @ y < h - abs(tolerance)):
        return None
    assert y @ y - u @ h <= 1e-6 * (1.0 + y @ y), "not the shortest movement"
    return y
