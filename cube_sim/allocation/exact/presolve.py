"""Before the search for the closest wrench: thrusters to which a far demand leaves no choice, and a nearer goal."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.sides import SideIntervals
from cube_sim.allocation.exact.solutions import WrenchMetric
from cube_sim.native.compiled import compiled
from cube_sim.wrench.tolerances import RANK_THRESHOLD


@compiled
def fix_thrusters(
    A: NDArray[np.float64],
    metric: WrenchMetric,
    intervals: SideIntervals,
    demand: NDArray[np.float64],
    bounds: NDArray[np.float64],
    descent: NDArray[np.float64],
    fixed: NDArray[np.bool_],
) -> int:
    """Find the thrusters that push to one end of their range in every closest answer, whatever the others do.

    Half the gradient of ``|W (A f - F)|^2`` along thruster i is ``G_i . G f - A_i . W^2 F``. The forces there are
    bound its first term. Where the second lies beyond that bound, the gradient keeps its sign, and the thruster goes
    to its end, exactly::

                    G_i . G f lies in here
        ---------|==========================|---------->  A_i . W^2 F
        to its lower end     not fixed       to its upper end

    A fixed thruster narrows the bounds of the others, so all are looked at again until no more is fixed.

    Args:
        A: (n, m).
        metric: of A, with G and the weights W.
        intervals: open to the thrusters; of ``relaxed`` only the interval ends are used.
        demand: (n,) F, finite.
        bounds: (m, 2) out: the forces each thruster may have in a closest answer [N]; both the same where it is fixed.
        descent: (m,) out: ``A_i . W^2 F``, minus half the gradient at f = 0.
        fixed: (m,) out: which thrusters are.

    Returns:
        How many are.
    """
    G = metric.G
    r, m = G.shape
    products = np.zeros((m, m))  # G_i . G_j
    for i in range(m):
        bounds[i, 0] = intervals.relaxed[i, intervals.masks[i], 0]
        bounds[i, 1] = intervals.relaxed[i, intervals.masks[i], 1]
        descent[i], fixed[i] = 0.0, False
        for a in range(demand.shape[0]):
            descent[i] += A[a, i] * metric.weights[a] * (metric.weights[a] * demand[a])
        for j in range(m):
            for b in range(r):
                products[i, j] += G[b, i] * G[b, j]
    count, before = 0, -1
    while count > before:
        before = count
        for i in range(m):
            if fixed[i]:
                continue
            least, most = 0.0, 0.0
            for j in range(m):
                one, other = products[i, j] * bounds[j, 0], products[i, j] * bounds[j, 1]
                least += min(one, other)
                most += max(one, other)
            if descent[i] > most:
                bounds[i, 0] = bounds[i, 1]
            elif descent[i] < least:
                bounds[i, 1] = bounds[i, 0]
            else:
                continue
            fixed[i] = True
            count += 1
    return count


@compiled
def reduce_goal(
    G: NDArray[np.float64],
    bounds: NDArray[np.float64],
    descent: NDArray[np.float64],
    fixed: NDArray[np.bool_],
    goal: NDArray[np.float64],
) -> None:
    """Write the shortest goal (r,) that has the same gradient for the thrusters that are not fixed.

    It has the same closest wrenches and is no farther away than the thrusters can make. A component of 1 N beside one
    of 1e8 N is then no longer what remains when numbers of that size are taken from each other.

    Args:
        G: (r, m) see `WrenchMetric`.
        bounds: (m, 2) from `fix_thrusters`.
        descent: (m,) from `fix_thrusters`; used up.
        fixed: (m,) from `fix_thrusters`.
        goal: (r,) out, in the coordinates s of `WrenchMetric`.
    """
    r, m = G.shape
    left, size, q = G.copy(), 0.0, np.empty(r)
    for b in range(r):
        goal[b] = 0.0
        for i in range(m):
            size = max(size, abs(G[b, i]))
            if fixed[i]:
                goal[b] += G[b, i] * bounds[i, 0]
    for i in range(m):
        for b in range(r):
            descent[i] -= G[b, i] * goal[b]
    # Gram and Schmidt, the longest column first: each direction of theirs once.
    for _ in range(r):
        longest, length = -1, RANK_THRESHOLD * size
        for i in range(m):
            square = 0.0
            for b in range(r):
                square += left[b, i] * left[b, i]
            if not fixed[i] and math.sqrt(square) > length:
                longest, length = i, math.sqrt(square)
        if longest < 0:
            break
        step = descent[longest] / length
        for b in range(r):
            q[b] = left[b, longest] / length
            goal[b] += step * q[b]
        for i in range(m):
            along = 0.0
            for b in range(r):
                along += q[b] * left[b, i]
            descent[i] -= along * step
            for b in range(r):
                left[b, i] -= along * q[b]
