"""Where the code of the search lies: it is large, and compiled once whoever calls it."""

from __future__ import annotations

from functools import cache

import numpy as np

from cube_sim.allocation.exact.solve import solve_each
from cube_sim.native.apart import finish
from cube_sim.native.compiled import address_of, on_disk

SEARCH = f"{__name__}:search_address"
"""What compiles the search, for `cube_sim.native.apart`."""
SEARCHED = (np.float64, np.float64, np.int64, np.int64, np.int64)
"""Types of what `solve_each` answers."""


@cache
def search_address() -> int:
    """Where the code of `solve_each` lies, which is large and answers `SEARCHED`."""
    if not on_disk(solve_each):
        finish(SEARCH)
    numbers = np.zeros(1)
    return address_of(solve_each, numbers, numbers, numbers, np.zeros(1, np.int8), answers=SEARCHED)
