"""The exact search for an unattainable wrench: the closest wrench that allowed forces can make."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.active_set import INFEASIBLE, STALLED, project
from cube_sim.allocation.exact.branch_and_bound import MOST_NODES
from cube_sim.allocation.exact.relaxation import branch, split
from cube_sim.allocation.exact.sides import SideIntervals
from cube_sim.allocation.exact.solutions import WrenchMetric
from cube_sim.native.compiled import compiled

CANDIDATES = 4096
"""Most distinct equally close wrenches kept, one for each strict subset of twelve thrusters. With more the answer
counts as not proven. Most vehicles have one, symmetric ones a handful."""

_ROOM = 32

FINE = 1e-3
"""Part of the rounding of forces that distances are told apart by: to miss a goal D away by x in a direction across it
makes only x^2 / 2D of difference."""

DOUBT = 1e6
"""Gap between an answer and its bound, in roundings, from which the answer counts as not proven."""


@compiled
def closest_wrenches(
    goal: NDArray[np.float64],
    metric: WrenchMetric,
    intervals: SideIntervals,
    bounds: NDArray[np.float64],
    tolerance: float,
) -> tuple[NDArray[np.float64], bool, int]:
    """Minimise ``|G @ f - goal|`` over forces on allowed sides, exactly over the union of all subsets.

    Branch and bound as in `branch_and_bound`, on another distance. In the coordinates (s, z) of `WrenchMetric` a node
    is again a projection; z costs nothing, so it is held by a proximal term that is moved to the last answer until
    the node is solved, and once more: a distance D right to x may leave the wrench sqrt(2 D x) off across it, the
    last step does not. What discards a node is not that answer but the plane it defines: with g the unit vector
    from the made to the wanted wrench, no force of the node comes closer than ``g.goal - max g.G f``, which
    is a sum over thrusters and holds whatever the rounding.

    Args:
        goal: (r,) demanded wrench in the coordinates s, no farther than a few times the vehicle's reach.
        metric: its coordinates and norm.
        intervals: open to the thrusters; of ``relaxed`` only the interval ends are used.
        bounds: (m, 2) forces each thruster may have in a closest answer [N].
        tolerance: force that counts as rounding [N].

    Returns:
        (c, m) forces making the equally closest, distinct wrenches; whether these are proven to be all; nodes solved.
    """
    G_pinv, null_space, G, relaxed = metric.G_pinv, metric.null_space, metric.G, intervals.relaxed
    m, k = null_space.shape
    r = goal.shape[0]
    d = r + k
    stack = np.empty((2 * m + 2, m), np.int64)
    bound = np.empty(2 * m + 2)
    mask = np.empty(m, np.int64)
    bottom, top, mu, f = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    start, point = np.empty(d), np.empty(d)
    made, g = np.empty(r), np.empty(r)
    forces, images = np.empty((_ROOM, m)), np.empty((_ROOM, r))
    size, fine = 0.0, FINE * tolerance
    for a in range(r):
        for i in range(m):
            size = max(size, abs(G[a, i]))
    near = size * fine  # wrench distance that counts as rounding
    rows = np.empty((m, d))
    for i in range(m):
        for a in range(r):
            rows[i, a] = G_pinv[i, a]
    best = math.inf
    found = 0
    proven = True
    solved = 0
    for i in range(m):
        stack[0, i] = intervals.masks[i]
    bound[0] = 0.0
    depth = 1
    while depth > 0:
        if solved >= MOST_NODES:
            proven = False
            break
        depth -= 1
        if bound[depth] > best + near:
            continue
        empty = False
        for i in range(m):
            mask[i] = stack[depth, i]
            bottom[i], top[i] = max(relaxed[i, mask[i], 0], bounds[i, 0]), min(relaxed[i, mask[i], 1], bounds[i, 1])
            empty = empty or bottom[i] > top[i]
        if empty:
            continue
        for a in range(d):
            start[a] = goal[a] if a < r else 0.0
        soft = 0.1 * size  # weight of the proximal term against the wrench
        lower, distance, settled = bound[depth], math.inf, False
        for _ in range(50):
            for i in range(m):
                for b in range(k):
                    rows[i, r + b] = null_space[i, b] / soft
            outcome = project(rows, bottom, top, start, math.inf, fine, point, mu)
            solved += 1
            if outcome == STALLED or outcome == INFEASIBLE:  # noqa: SIM109 - compiles faster
                break
            for i in range(m):
                f[i] = 0.0
                for a in range(d):
                    f[i] += rows[i, a] * point[a]
                f[i] = min(max(f[i], bottom[i]), top[i])
            distance = 0.0
            for a in range(r):
                made[a] = 0.0
                for i in range(m):
                    made[a] += G[a, i] * f[i]
                g[a] = goal[a] - made[a]
                distance += g[a] * g[a]
            distance = math.sqrt(distance)
            if distance > 0.0:
                plane = 0.0
                for a in range(r):
                    plane += g[a] * goal[a]
                for i in range(m):
                    along = 0.0
                    for a in range(r):
                        along += g[a] * G[a, i]
                    plane -= max(along * bottom[i], along * top[i])
                lower = max(lower, plane / distance)
            if lower > best + near or settled:
                break
            settled = distance - lower <= near + 1e-12 * distance
            # A weaker term lets z travel further next time, which a short distance to the goal needs.
            shrink = 0.1 if soft > 1e-5 * size else 1.0
            for a in range(r, d):
                start[a] = shrink * point[a]
            soft *= shrink
        if lower > best + near:
            continue
        if distance - lower > DOUBT * near + 1e-9 * distance:
            proven = False
            if distance == math.inf:
                continue
        repeated = False
        for c in range(found):
            gap = 0.0
            for a in range(r):
                gap = max(gap, abs(images[c, a] - made[a]))
            repeated = repeated or gap <= 1e6 * near
        if repeated and distance >= best - near:
            continue
        chosen, furthest = -1, tolerance  # half of what the search for the forces accepts
        for i in range(m):
            gap = math.inf
            for s in range(3):
                if mask[i] >> s & 1 and intervals.low[i, s] <= intervals.high[i, s]:
                    gap = min(gap, max(intervals.low[i, s] - f[i], f[i] - intervals.high[i, s]))
            if gap > furthest:
                chosen, furthest = i, gap
        if chosen < 0:
            if distance < best - near:
                found = 0
            best = min(best, distance)
            if found == CANDIDATES:
                proven = False
                continue
            if found == forces.shape[0]:
                forces = np.concatenate((forces, np.empty((found, m))))
                images = np.concatenate((images, np.empty((found, r))))
            for i in range(m):
                forces[found, i] = f[i]
            for a in range(r):
                images[found, a] = made[a]
            found += 1
            continue
        first, second = split(f[chosen], chosen, mask[chosen], intervals)
        depth = branch(stack, bound, depth, mask, chosen, (second, first), lower)
    return forces[:found], proven, solved
