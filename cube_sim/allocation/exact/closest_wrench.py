"""The exact search for an unattainable wrench: the closest wrench that allowed forces can make."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.active_set import INFEASIBLE, STALLED, project_within, scratch
from cube_sim.allocation.exact.branch_and_bound import MOST_NODES
from cube_sim.allocation.exact.relaxation import branch, split
from cube_sim.allocation.exact.sides import SideIntervals
from cube_sim.allocation.exact.solutions import WrenchMetric
from cube_sim.native.compiled import compiled, inlined

CANDIDATES = 4096
"""Most distinct equally close wrenches kept, one for each strict subset of twelve thrusters. With more the answer
counts as not proven. Most vehicles have one, symmetric ones a handful."""

_FIRST_ROWS = 32
"""Candidates there is memory for at first; it doubles whenever it is full."""

FINE = 1e-3
"""Part of the rounding of forces that distances are told apart by: to miss a goal D away by x in a direction across it
makes only x^2 / 2D of difference."""

DOUBT = 1e6
"""Gap between an answer and its bound, in roundings, from which the answer counts as not proven."""


@inlined
def open_node(
    node: NDArray[np.int64],
    relaxed: NDArray[np.float64],
    bounds: NDArray[np.float64],
    mask: NDArray[np.int64],
    bottom: NDArray[np.float64],
    top: NDArray[np.float64],
) -> bool:
    """Write a node's open sides (m,) and the interval (m,) they leave each thruster; return whether none is empty."""
    possible = True
    for i in range(node.shape[0]):
        mask[i] = node[i]
        bottom[i], top[i] = max(relaxed[i, mask[i], 0], bounds[i, 0]), min(relaxed[i, mask[i], 1], bounds[i, 1])
        possible = possible and not bottom[i] > top[i]
    return possible


@inlined
def distance_left(
    G: NDArray[np.float64],
    goal: NDArray[np.float64],
    f: NDArray[np.float64],
    made: NDArray[np.float64],
    g: NDArray[np.float64],
) -> float:
    """Write ``G @ f`` (r,) and what is left to the goal (r,); return its length."""
    square = 0.0
    for a in range(goal.shape[0]):
        made[a] = 0.0
        for i in range(f.shape[0]):
            made[a] += G[a, i] * f[i]
        g[a] = goal[a] - made[a]
        square += g[a] * g[a]
    return math.sqrt(square)


@inlined
def plane_bound(
    G: NDArray[np.float64],
    goal: NDArray[np.float64],
    g: NDArray[np.float64],
    distance: float,
    bottom: NDArray[np.float64],
    top: NDArray[np.float64],
) -> float:
    """Distance of the goal from the plane across g beyond which no force between bottom and top (m,) gets.

    ``(g.goal - max g.G f) / |g|``: the maximum is a sum over the thrusters, each at one end of its interval.
    """
    plane = 0.0
    for a in range(goal.shape[0]):
        plane += g[a] * goal[a]
    for i in range(bottom.shape[0]):
        along = 0.0
        for a in range(goal.shape[0]):
            along += g[a] * G[a, i]
        plane -= max(along * bottom[i], along * top[i])
    return plane / distance


@inlined
def solve_node(
    goal: NDArray[np.float64],
    G: NDArray[np.float64],
    null_space: NDArray[np.float64],
    lower: float,
    best: float,
    near: float,
    size: float,
    fine: float,
    bottom: NDArray[np.float64],
    top: NDArray[np.float64],
    rows: NDArray[np.float64],
    start: NDArray[np.float64],
    point: NDArray[np.float64],
    mu: NDArray[np.float64],
    work: NDArray[np.float64],
    active: NDArray[np.int64],
    f: NDArray[np.float64],
    made: NDArray[np.float64],
    g: NDArray[np.float64],
) -> tuple[float, float, int]:
    """Find the forces between bottom and top whose wrench is closest to the goal, unless none can be the best.

    z costs nothing. So it is held by a proximal term ``(soft z)^2``, which is moved to the last answer until the node
    is solved, and once more: a distance D right to x may leave the wrench sqrt(2 D x) off across it, the last step
    does not.

    Args:
        goal: (r,) see `closest_wrenches`.
        G: (r, m) see `WrenchMetric`.
        null_space: (m, k) likewise.
        lower: bound of the node.
        best: distance of the closest wrench found.
        near: wrench distance that counts as rounding.
        size: largest entry of G.
        fine: violation of a force interval that counts as none [N].
        bottom: (m,) [N].
        top: (m,) [N].
        rows: (m, r + k) [G_pinv, null_space / soft], the latter written here.
        start: (r + k,) scratch, as are point (r + k,) and mu (m,).
        point: scratch.
        mu: scratch.
        work: of `cube_sim.allocation.exact.active_set.scratch`, like the next.
        active: of it.
        f: (m,) out [N].
        made: (r,) out: ``G @ f``.
        g: (r,) out: ``goal - made``.

    Returns:
        Lower bound of the distance, its value, and the projections it took.
    """
    r, (m, k) = goal.shape[0], null_space.shape
    distance, settled, solved = math.inf, False, 0
    for a in range(r + k):
        start[a] = goal[a] if a < r else 0.0
    soft = 0.1 * size  # weight of the proximal term against the wrench
    for _ in range(50):
        for i in range(m):
            for b in range(k):
                rows[i, r + b] = null_space[i, b] / soft
        outcome = project_within(rows, bottom, top, start, math.inf, fine, point, mu, work, active)
        solved += 1
        if outcome == STALLED or outcome == INFEASIBLE:  # noqa: SIM109 - compiles faster
            break
        for i in range(m):
            f[i] = 0.0
            for a in range(r + k):
                f[i] += rows[i, a] * point[a]
            f[i] = min(max(f[i], bottom[i]), top[i])
        distance = distance_left(G, goal, f, made, g)
        if distance > 0.0:
            lower = max(lower, plane_bound(G, goal, g, distance, bottom, top))
        if lower > best + near or settled:
            break
        settled = distance - lower <= near + 1e-12 * distance
        # A weaker term lets z travel further next time, which a short distance to the goal needs.
        shrink = 0.1 if soft > 1e-5 * size else 1.0
        for a in range(r, r + k):
            start[a] = shrink * point[a]
        soft *= shrink
    return lower, distance, solved


@inlined
def furthest_off(f: NDArray[np.float64], mask: NDArray[np.int64], intervals: SideIntervals, tolerance: float) -> int:
    """The thruster whose force lies furthest from its open sides, by more than a tolerance; -1 when all lie on them."""
    chosen, furthest = -1, tolerance
    for i in range(f.shape[0]):
        gap = math.inf
        for s in range(3):
            if mask[i] >> s & 1 and intervals.low[i, s] <= intervals.high[i, s]:
                gap = min(gap, max(intervals.low[i, s] - f[i], f[i] - intervals.high[i, s]))
        if gap > furthest:
            chosen, furthest = i, gap
    return chosen


@inlined
def made_before(
    images: NDArray[np.float64],
    distances: NDArray[np.float64],
    found: int,
    made: NDArray[np.float64],
    distance: float,
    rounding: float,
) -> bool:
    """Whether a wrench (r,) is one of those found so far, and no closer than it was then."""
    repeated = False
    for c in range(found):
        gap = 0.0
        for a in range(made.shape[0]):
            gap = max(gap, abs(images[c, a] - made[a]))
        repeated = repeated or (gap <= rounding and distance >= distances[c])
    return repeated


@inlined
def closest_first(
    forces: NDArray[np.float64], distances: NDArray[np.float64], best: float, near: float, wide: float
) -> tuple[NDArray[np.float64], int]:
    """Rows of forces (c, m) that are near the best or wide of it, in their order but the near ones first.

    Args:
        forces: what makes each wrench.
        distances: (c, ...) of the wrenches.
        best: the least of these.
        near: how much farther counts as equally close.
        wide: and as close but for A's rounding.

    Returns:
        The rows, and how many of them are near.
    """
    ordered, rows, count = np.empty_like(forces), 0, 0
    for last in (False, True):
        for c in range(forces.shape[0]):
            if distances[c] <= best + max(near, wide) and (distances[c] > best + near) == last:
                for i in range(forces.shape[1]):
                    ordered[rows, i] = forces[c, i]
                rows += 1
        if not last:
            count = rows
    return ordered[:rows], count


@compiled
def closest_wrenches(
    goal: NDArray[np.float64],
    metric: WrenchMetric,
    intervals: SideIntervals,
    bounds: NDArray[np.float64],
    tolerance: float,
    hidden: float,
) -> tuple[NDArray[np.float64], int, bool, int]:
    """Minimise ``|G @ f - goal|`` over forces on allowed sides, exactly over the union of all subsets.

    Branch and bound as in `branch_and_bound`, on another distance. In the coordinates (s, z) of `WrenchMetric` a node
    is again a projection, of the goal onto the wrenches its forces can make::

        the node's .......|
        wrenches   .......|
                   .......x------ g ------> goal
                   .......|
                          | plane across g: no force of the node makes a wrench beyond it

    What bounds the node is not the projection but this plane: it holds whatever the rounding.

    ==========================================  ================================================================
    the node                                    what follows
    ==========================================  ================================================================
    has no forces, or a bound above the best    leave it
    is solved badly                             the answer counts as not proven; go on with what there is
    makes a wrench found before, no closer      leave it
    has a thruster off its sides                divide the node: the thruster that is furthest off decides
    lies on allowed sides                       keep the wrench; forget the others if it is closer than they are
    ==========================================  ================================================================

    What is above the best, and what is closer, is so by more than the wrench that the rounding of A hides: by the
    matrix that was meant, what is kept beside the closest may be as close.

    Args:
        goal: (r,) demanded wrench in the coordinates s, no farther than a few times the largest wrench.
        metric: its coordinates and norm.
        intervals: open to the thrusters; of ``relaxed`` only the interval ends are used.
        bounds: (m, 2) forces each thruster may have in a closest answer [N].
        tolerance: force that counts as rounding [N].
        hidden: force that the rounding of A's entries hides [N].

    Returns:
        (c, m) forces making distinct wrenches, first the equally closest, then those as close but for A's rounding; how
        many are the closest; whether these are proven to be all; nodes solved.
    """
    G_pinv, null_space, G = metric.G_pinv, metric.null_space, metric.G
    m, k = null_space.shape
    r = goal.shape[0]
    d = r + k
    stack, lower_bounds, mask = np.empty((2 * m + 2, m), np.int64), np.empty(2 * m + 2), np.empty(m, np.int64)
    bottom, top, mu, f = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    start, point = np.empty(d), np.empty(d)
    work, active = scratch(d)
    made, g = np.empty(r), np.empty(r)
    forces, images = np.empty((_FIRST_ROWS, m)), np.empty((_FIRST_ROWS, r))
    distances = np.empty(_FIRST_ROWS)
    size, least, fine = 0.0, math.inf, FINE * tolerance
    for i in range(m):
        gain = 0.0
        for a in range(r):
            gain = max(gain, abs(G[a, i]))
        size, least = max(size, gain), min(least, gain) if gain > 0.0 else least
    near = size * fine  # wrench distance that counts as rounding
    wide = max(min(least, size) * hidden, near)  # and as A's: what is hidden of the force that makes least
    rows = np.empty((m, d))
    for i in range(m):
        for a in range(r):
            rows[i, a] = G_pinv[i, a]
    best, found, proven, solved = math.inf, 0, True, 0
    for i in range(m):
        stack[0, i] = intervals.masks[i]
    lower_bounds[0] = 0.0
    depth = 1
    while depth > 0:
        if solved >= MOST_NODES:
            proven = False
            break
        depth -= 1
        if lower_bounds[depth] > best + wide:
            continue
        if not open_node(stack[depth], intervals.relaxed, bounds, mask, bottom, top):
            continue
        lower, distance, looked = solve_node(
            goal,
            G,
            null_space,
            lower_bounds[depth],
            best + wide,
            near,
            size,
            fine,
            bottom,
            top,
            rows,
            start,
            point,
            mu,
            work,
            active,
            f,
            made,
            g,
        )
        solved += looked
        if lower > best + wide:
            continue
        closest = lower <= best + near
        if distance - lower > DOUBT * near + 1e-9 * distance:
            proven = proven and not closest
            if distance == math.inf:
                continue
        if made_before(images, distances, found, made, distance + near + 1e-12 * distance, 1e6 * near):
            continue
        chosen = furthest_off(f, mask, intervals, tolerance)  # half of what the search for the forces accepts
        if chosen >= 0:
            first, second = split(f[chosen], chosen, mask[chosen], intervals)
            depth = branch(stack, lower_bounds, depth, mask, chosen, (second, first), lower)
            continue
        if distance < best - wide:
            found = 0
        best = min(best, distance)
        if found == CANDIDATES:
            proven = proven and not closest
            continue
        if found == forces.shape[0]:
            forces = np.concatenate((forces, np.empty((found, m))))
            images = np.concatenate((images, np.empty((found, r))))
            distances = np.concatenate((distances, np.empty(found)))
        distances[found] = distance
        for i in range(m):
            forces[found, i] = f[i]
        for a in range(r):
            images[found, a] = made[a]
        found += 1
    return *closest_first(forces[:found], distances, best, 2.0 * near + 1e-12 * best, wide), proven, solved
