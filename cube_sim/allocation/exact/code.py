"""Where the code of the search lies: it is large, and compiled once whoever calls it."""

from __future__ import annotations

from functools import cache

import numpy as np

from cube_sim.allocation.exact.solve import solve_each
from cube_sim.native.apart import finish
from cube_sim.native.callee import Callee

SEARCH = f"{__name__}:search_address"
"""What compiles the search, for `cube_sim.native.apart`."""
_NUMBERS = np.zeros(1)
SEARCHING = Callee(
    solve_each,
    lambda: (_NUMBERS, _NUMBERS, _NUMBERS, np.zeros(1, np.int8)),
    answers=(np.float64, np.float64, np.int64, np.int64, np.int64),
)
"""`solve_each`, which is large."""


@cache
def search_address() -> int:
    """Where the code of `SEARCHING` lies."""
    if not SEARCHING.on_disk:
        finish(SEARCH)
    return SEARCHING.address()
