"""A compiled rule of the user's own in the place of a baseline's: asked by its address, its forces assessed alike."""

from __future__ import annotations

from math import isfinite, nan

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.baselines.flown import assess, unpacked
from cube_sim.allocation.baselines.packing import HEADER
from cube_sim.allocation.exact.solve import answer_of
from cube_sim.native.asking import WORD, ask_at
from cube_sim.native.compiled import compiled
from cube_sim.tuples import put


def pack_own_rule(
    baseline: NDArray[np.float64], parameters: NDArray[np.float64], memory: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What `answer_by_own_rule` answers by, in one array.

    Args:
        baseline: of `pack_baseline`; in its first number, the rule, stands how many words the parameters have.
        parameters: their words.
        memory: its words; they come last but for their copy and the demand asked last.
    """
    packed = np.concatenate([baseline, parameters, memory, memory, np.zeros(int(baseline[1]))])
    packed[0] = len(parameters)
    return packed


@compiled
def places(packed):
    """Where parameters, memory, the copy of that and the demand begin."""
    n, m = int(packed[1]), int(packed[2])
    first = HEADER + 2 * n * m + 5 * m + 1
    second = first + int(packed[0])
    words = (len(packed) - second - n) // 2
    return first, second, second + words, second + 2 * words


@compiled
def answer_by_own_rule(search, travel, packed, demands, row, sides, effort):
    """Answer one finite demand; the arguments are those of `cube_sim.allocation.exact.fewest_calls.solve_in_reach`.

    Args:
        search: address of the rule.
        travel: not used.
        packed: see `pack_own_rule`; its memory moves on where there is an answer.
        demands: (n,), or (2 n,) for one of two parts, of which the sum is answered.
        row: of `answer_of`, out; its residual is NaN where the rule has no answer.
        sides: (m,) out.
        effort: not used.
    """
    A, _, limits, _, _ = unpacked(packed)
    n, m = A.shape
    first, second, third, fourth = places(packed)
    answer, demand = answer_of(row, n, m), np.empty(n)
    for a in range(n):
        demand[a] = demands[a] if len(demands) == n else demands[a] + demands[n + a]
    memory, kept = packed[second:third], packed[third:fourth]
    put(kept, memory)
    put(packed[fourth:], demand)
    told = demand.copy(), packed[first:second].view(WORD)[0], memory.view(WORD)[0]
    has, force = ask_at(demand, search, told)
    total = 0.0
    if has and len(force) == m:
        for i in range(m):
            answer.force[i] = force[i] + 0.0  # no force has no sign
            total += abs(force[i])
    else:
        total = nan
    if not isfinite(total):
        put(memory, kept)
        answer.force[:] = 0.0
    worth = limits, packed[3] != 0.0, int(packed[4]), packed[5], packed[6], demand, answer.force
    residual, cost, status = assess(A, *worth, answer.wrench, answer.error, sides)
    answer.rest[0], answer.rest[1], answer.rest[2] = residual if isfinite(total) else nan, cost, status
