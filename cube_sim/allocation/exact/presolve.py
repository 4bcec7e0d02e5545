"""Motors to which a far demand leaves no choice, and what the others still feel of it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.sides import Sides
from cube_sim.allocation.exact.solutions import RANK_THRESHOLD, WrenchDistance
from cube_sim.native.compiled import compiled


@compiled
def commit(
    A: NDArray[np.float64],
    space: WrenchDistance,
    sides: Sides,
    demand: NDArray[np.float64],
    span: NDArray[np.float64],
    pull: NDArray[np.float64],
    committed: NDArray[np.bool_],
) -> int:
    """Find the motors that push to one end of their range in every closest answer, whatever the others do.

    Half the gradient of ``|W (A f - F)|^2`` along motor i is ``G_i . G f - A_i . W^2 F``, and what forces there are
    bound the first term. Where the second is beyond that bound, the motor goes to its end, exactly.

    Args:
        A: (n, m).
        space: of A, with the gain G and the weights W.
        sides: open to the motors; of ``relaxed`` only the interval ends are used.
        demand: (n,) F, finite.
        span: (m, 2) out: the forces each motor may have in a closest answer [N]; both the same where it is committed.
        pull: (m,) out: ``A_i . W^2 F``.
        committed: (m,) out: which motors are.

    Returns:
        How many are.
    """
    gain = space.gain
    r, m = gain.shape
    mutual = np.zeros((m, m))
    for i in range(m):
        span[i, 0], span[i, 1] = sides.relaxed[i, sides.masks[i], 0], sides.relaxed[i, sides.masks[i], 1]
        pull[i], committed[i] = 0.0, False
        for a in range(demand.shape[0]):
            pull[i] += A[a, i] * space.weights[a] * (space.weights[a] * demand[a])
        for j in range(m):
            for b in range(r):
                mutual[i, j] += gain[b, i] * gain[b, j]
    count, before = 0, -1
    while count > before:
        before = count
        for i in range(m):
            if committed[i]:
                continue
            least, most = 0.0, 0.0
            for j in range(m):
                one, other = mutual[i, j] * span[j, 0], mutual[i, j] * span[j, 1]
                least += min(one, other)
                most += max(one, other)
            if pull[i] > most:
                span[i, 0] = span[i, 1]
            elif pull[i] < least:
                span[i, 1] = span[i, 0]
            else:
                continue
            committed[i] = True
            count += 1
    return count


@compiled
def felt(
    gain: NDArray[np.float64],
    span: NDArray[np.float64],
    pull: NDArray[np.float64],
    committed: NDArray[np.bool_],
    goal: NDArray[np.float64],
) -> None:
    """Write the shortest goal (r,) that pulls the motors which are not committed as the demand does.

    It has the same closest wrenches and is no farther away than the motors reach: a component of 1 N beside one of
    1e8 N is no longer what remains when numbers of that size are taken from each other.

    Args:
        gain: (r, m) G.
        span: (m, 2) from `commit`.
        pull: (m,) from `commit`; used up.
        committed: (m,) from `commit`.
        goal: (r,) out, in the coordinates s of `WrenchDistance`.
    """
    r, m = gain.shape
    left, size, q = gain.copy(), 0.0, np.empty(r)
    for b in range(r):
        goal[b] = 0.0
        for i in range(m):
            size = max(size, abs(gain[b, i]))
            if committed[i]:
                goal[b] += gain[b, i] * span[i, 0]
    for i in range(m):
        for b in range(r):
            pull[i] -= gain[b, i] * goal[b]
    # Gram and Schmidt, the longest column first: each direction of theirs once.
    for _ in range(r):
        longest, length = -1, RANK_THRESHOLD * size
        for i in range(m):
            square = 0.0
            for b in range(r):
                square += left[b, i] * left[b, i]
            if not committed[i] and math.sqrt(square) > length:
                longest, length = i, math.sqrt(square)
        if longest < 0:
            break
        step = pull[longest] / length
        for b in range(r):
            q[b] = left[b, longest] / length
            goal[b] += step * q[b]
        for i in range(m):
            along = 0.0
            for b in range(r):
                along += q[b] * left[b, i]
            pull[i] -= along * step
            for b in range(r):
                left[b, i] -= along * q[b]
