"""The closest attainable wrench and its least cost, by bounded least squares on every subset.

Slow and literal, it shares no code with the product, and no idea with its branch and bound: each subset is one problem.
One is left out only when a half-space that holds all its wrenches (Qhull's) is farther from the demand than a wrench
found. What is solved is checked by a theorem, not believed: the signs of the gradient at a solution bound how much
closer any other forces of its subset can come.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from cube_sim.wrench.tolerances import MATRIX_ROUNDING
from support.every_subset import EverySubset, kernel_of, least_move


class Closest(NamedTuple):
    """The closest wrench of each subset.

    Attributes:
        distance: (s,) weighted distance of the demand from it; inf for a subset left out, whose wrenches are all
            farther than the closest, by more than rounding.
        force: (s, m) forces making it, not the cheapest.
        push: (s, m) by how much half the squared distance would shrink with each thruster's force.
        noise: (m,) rounding of ``push``.
        size: (m,) largest push per unit of distance.
    """

    distance: np.ndarray
    force: np.ndarray
    push: np.ndarray
    noise: np.ndarray
    size: np.ndarray


class Rounding(NamedTuple):
    """What counts as rounding where the least cost is asked for.

    Attributes:
        force: interval ends are so much wider, or narrower when it is negative [N].
        equal: distances are equal that differ by less, part of 1 + themselves.
        push: a thruster is free that is pushed less, part of the largest push at that distance.
    """

    force: float
    equal: float
    push: float


USUAL, MORE, LESS = Rounding(1e-7, 1e-9, 1e-9), Rounding(2e-6, 1e-6, 2e-8), Rounding(-2e-6, 1e-14, 1e-11)


class ClosestOfEverySubset:
    """Bounded least squares on every subset of a vehicle.

    What no forces of any size can make is left out: ``M f`` is the weighted wrench in coordinates of range(W A).

    Attributes:
        M: (r, m).
        hidden_N: force that the rounding of A's entries hides.
        tie: distance that it makes with the thruster that makes least of it.
        farthest: most that an answer may be farther than the closest wrench, for forces that are cheaper.
    """

    def __init__(self, every: EverySubset, wrench_weights):
        self.every = every
        U, sigma, _ = np.linalg.svd(wrench_weights[:, None] * every.A)
        self.inside = U[:, : int(np.sum(sigma > 1e-9 * sigma[0]))].T * wrench_weights
        self.M = self.inside @ every.A
        normals = (every.normals / wrench_weights**2) @ self.inside.T  # a plane's normal in these coordinates
        lengths = np.linalg.norm(normals, axis=1)
        self.normals = normals / lengths[:, None]
        self.least, self.most = every.least / lengths, every.most / lengths
        self.kernels = {}
        gains = np.abs(self.M).max(axis=0)
        self.hidden_N = MATRIX_ROUNDING * np.abs(every.limits).max()
        self.tie = self.hidden_N * gains[gains > 0.0].min()
        self.farthest = self.tie + 2.001 * self.hidden_N * np.linalg.norm(self.M, axis=0).sum()

    def find(self, wrench) -> Closest:
        """Bounded least squares on every subset that may hold a wrench as close as any, but for the rounding of A."""
        low, high = self.every.low, self.every.high
        goal = self.inside @ wrench
        size = np.linalg.norm(self.M, axis=0)
        noise = 1e-14 * size * (np.linalg.norm(goal) + np.abs(self.every.limits).max(axis=1) @ size)
        value = self.normals @ goal
        bound = np.maximum(self.least - value, value - self.most).max(axis=1)
        distance, force, push = np.full(len(low), np.inf), np.zeros(low.shape), np.zeros(low.shape)
        solve_each(
            self.M, goal, low, high, bound, np.argsort(bound), MORE.equal, self.farthest, noise, distance, force, push
        )
        assert not np.any(np.isnan(distance)), "no end to the thrusters that are freed"
        solved = np.isfinite(distance)
        low, high, f, g = low[solved], high[solved], force[solved], push[solved]
        # No other forces f' of the box come closer than by sum(push * (f' - f)) in half the squared distance.
        assert np.all((low <= f) & (f <= high))
        assert np.all(np.maximum(g * (low - f), g * (high - f)) <= noise * (high - low)), "not the closest wrench"
        assert np.all(distance[solved] >= bound[solved] - 1e-9 * (1.0 + distance[solved])), "beyond its half-space"
        return Closest(distance, force, push, noise, size)

    def cheapest(self, closest: Closest, side_target, penalty, rounding: Rounding):
        """Least cost of forces making one of the closest wrenches, and whether there are several such forces.

        The forces of a subset that make its closest wrench have every thruster that is pushed at its end; others make
        the same wrench together.

        Args:
            closest: from `find`.
            side_target: (m, 3).
            penalty: (m, 3).
            rounding: what counts as equally close, as pushed, and as within an interval.
        """
        every, root = self.every, self.every.root
        thrusters = np.arange(len(root))
        best, equal = np.inf, closest_subsets(closest, rounding.equal)
        several = len(equal) > 1
        for s in equal:
            at = thrusters, every.subsets[s] + 1
            t, f = side_target[at], closest.force[s]
            pushed = np.abs(closest.push[s]) > closest.noise + rounding.push * closest.size * closest.distance[s]
            free = ~pushed & (every.low[s] < every.high[s])
            N = self.kernel(free)
            g = root[free] * (f[free] - t[free])
            centre = g - N @ (N.T @ g)
            low, high = (root[free] * (end[s][free] - t[free]) - centre for end in (every.low, every.high))
            y = least_move(N, low, high, rounding.force) if N.shape[1] else np.zeros(0)
            several |= N.shape[1] > 0
            if y is not None:
                cost = np.sum((root * (f - t))[~free] ** 2) + centre @ centre + y @ y + penalty[at].sum()
                best = min(best, float(cost))
        return best, several

    def kernel(self, free):
        """(z, k) orthonormal movements of the free thrusters, scaled by the root of their weights, without a wrench."""
        key = free.tobytes()
        if key not in self.kernels:
            self.kernels[key] = kernel_of(self.M[:, free] / self.every.root[free])
        return self.kernels[key]


def closest_subsets(closest: Closest, equal):
    """Subsets as close as any, but for a part ``equal`` of 1 + the distance."""
    least = closest.distance.min()
    return np.flatnonzero(closest.distance <= least + equal * (1.0 + least))


@numba.njit(cache=True)
def solve_each(M, goal, low, high, bound, order, slack, farthest, noise, distance, force, push):
    """Bounded least squares on subset after subset, until the bounds (s,) say that those left are farther."""
    best = np.inf
    for s in order:
        if bound[s] > best + max(slack * (1.0 + best), farthest):
            break
        distance[s] = bounded_least_squares(M, goal, low[s], high[s], noise, force[s], push[s])
        best = min(best, distance[s])


@numba.njit(cache=True)
def bounded_least_squares(M, goal, low, high, noise, f, push):
    """Least ``|goal - M f|`` over ``low <= f <= high`` (Stark & Parker 1995); writes f and its push, M' (goal - M f).

    All thrusters start at an end. The one pushed most from its end is freed, the free ones go to their least-squares
    solution; those that meet an end on the way stay there. None is pushed from its end by more than noise in the end.
    """
    r, m = M.shape
    free, rest, z = np.zeros(m, np.bool_), np.empty(r), np.empty(m)
    f[:] = low
    for _ in range(1000):
        left_over(M, goal, f, free, False, rest)
        chosen, most = -1, 1.0
        for i in range(m):
            push[i] = 0.0
            for a in range(r):
                push[i] += M[a, i] * rest[a]
            inwards = push[i] if f[i] == low[i] else -push[i]
            if low[i] < high[i] and not free[i] and inwards > most * noise[i]:
                chosen, most = i, inwards / noise[i]
        if chosen < 0:
            break
        free[chosen], met = True, chosen
        while met >= 0:
            left_over(M, goal, f, free, True, rest)
            least_squares(M, free, rest, z)
            step, met = 1.0, -1
            for i in range(m):
                if free[i] and (z[i] < low[i] or z[i] > high[i]):
                    part = ((low[i] if z[i] < low[i] else high[i]) - f[i]) / (z[i] - f[i])
                    if met < 0 or part < step:
                        step, met = part, i
            for i in range(m):
                if free[i]:
                    f[i] = min(max(f[i] + step * (z[i] - f[i]), low[i]), high[i])
            if met >= 0:
                f[met] = low[met] if z[met] < low[met] else high[met]
                free[met] = False
    else:
        return np.nan
    square = 0.0
    for a in range(r):
        square += rest[a] * rest[a]
    return np.sqrt(square)


@numba.njit(cache=True)
def left_over(M, goal, f, free, without_free, rest):
    """Write ``goal - M f``, of thrusters that are not free only if wanted."""
    for a in range(M.shape[0]):
        rest[a] = goal[a]
        for i in range(M.shape[1]):
            if not (without_free and free[i]):
                rest[a] -= M[a, i] * f[i]


@numba.njit(cache=True)
def least_squares(M, free, rest, z):
    """Write the z of the free columns that leaves least of ``rest`` (used up), by Gram and Schmidt."""
    r, m = M.shape
    Q, R = M.copy(), np.zeros((m, m))
    for i in range(m):
        if not free[i]:
            continue
        for a in range(r):
            R[i, i] += Q[a, i] * Q[a, i]
        R[i, i] = np.sqrt(R[i, i])
        z[i] = 0.0
        for a in range(r):
            Q[a, i] /= R[i, i]
            z[i] += Q[a, i] * rest[a]
        for a in range(r):
            rest[a] -= Q[a, i] * z[i]
        for j in range(i + 1, m):
            for a in range(r):
                R[i, j] += Q[a, i] * Q[a, j]
            for a in range(r):
                Q[a, j] -= R[i, j] * Q[a, i]
    for i in range(m - 1, -1, -1):
        if free[i]:
            for j in range(i + 1, m):
                if free[j]:
                    z[i] -= R[i, j] * z[j]
            z[i] /= R[i, i]
