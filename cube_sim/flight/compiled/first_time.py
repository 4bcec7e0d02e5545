"""The first flight on a machine, or after an update: everything has to be compiled."""

from __future__ import annotations

from functools import cache

from cube_sim.allocation.exact.code import SEARCH
from cube_sim.allocation.exact.solve import solve_each
from cube_sim.flight.compiled.loop import fly
from cube_sim.flight.compiled.steering import LAW
from cube_sim.native import apart
from cube_sim.native.compiled import on_disk


@cache
def compile_beside() -> bool:
    """Whether there is no machine code yet; a second process then begins to make its half of it."""
    if not on_disk(solve_each):
        apart.begin(SEARCH, LAW)
        return True
    return not on_disk(fly)
