"""The baselines compiled, for the loop of a flight: the numbers are those of `rules` run by the interpreter."""

from __future__ import annotations

from functools import cache

import numpy as np

from cube_sim.allocation.baselines import rules
from cube_sim.allocation.baselines.packing import CLIPPED, COMPENSATION, CONTRACTION, unpack_baseline
from cube_sim.allocation.exact.fewest_calls import INSTEAD
from cube_sim.allocation.exact.solve import answer_of
from cube_sim.allocation.flown import SearchCodes
from cube_sim.native.compiled import compiled
from cube_sim.tuples import put

unpacked = compiled(unpack_baseline)
least_squares = compiled(rules.least_squares)
clip = compiled(rules.clip)
contract = compiled(rules.contract)
compensate = compiled(rules.compensate)
assess = compiled(rules.assess)


@compiled
def answer_by_rule(search, travel, packed, demands, row, sides, effort):
    """Answer one finite demand; the arguments are those of `cube_sim.allocation.exact.fewest_calls.solve_in_reach`.

    Args:
        search: not used.
        travel: not used.
        packed: see `pack_baseline`.
        demands: (n,), or (2 n,) for one of two parts, of which the sum is answered.
        row: of `answer_of`, out.
        sides: (m,) out.
        effort: not used.
    """
    A, inverse, limits, regime, direction = unpacked(packed)
    rule, allow_off, forces, rounding = int(packed[0]), packed[3] != 0.0, int(packed[4]), packed[7]
    n, m = A.shape
    answer, demand, asked = answer_of(row, n, m), np.empty(n), np.empty(m)
    for a in range(n):
        demand[a] = demands[a] if len(demands) == n else demands[a] + demands[n + a]
    least_squares(inverse, demand, asked)
    if rule == CLIPPED:
        clip(limits, allow_off, asked, answer.force)
    elif rule == CONTRACTION:
        contract(limits, allow_off, rounding, asked, answer.force)
    elif rule == COMPENSATION:
        compensate(limits, regime, direction, asked, answer.force)
    else:
        put(answer.force, asked)
    for i in range(m):
        answer.force[i] += 0.0  # no force has no sign
    worth = limits, allow_off, forces, packed[5], packed[6], demand, answer.force
    answer.rest[0], answer.rest[1], answer.rest[2] = assess(A, *worth, answer.wrench, answer.error, sides)


@cache
def baseline_codes() -> SearchCodes:
    """Where the code of the baselines lies; it is compiled only for those who fly by one."""
    return SearchCodes(0, INSTEAD.address(answer_by_rule), 0)
