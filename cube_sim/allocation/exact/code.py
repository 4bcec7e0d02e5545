"""Where the code of the search lies: it is large, and compiled once whoever calls it."""

from __future__ import annotations

from functools import cache

import numpy as np

from cube_sim.allocation.exact.solve import solve_each
from cube_sim.native.apart import finish
from cube_sim.native.compiled import address_of

SEARCH = f"{__name__}:search_code"
"""What compiles the search, for `cube_sim.native.apart`."""


def search_code() -> None:
    """Have the code of `solve_each` on disk."""
    search_address()


@cache
def search_address() -> int:
    """Where the code of `solve_each` lies, which is large."""
    finish(SEARCH)
    numbers = np.zeros(1)
    return address_of(solve_each, numbers, numbers, numbers, np.zeros(1, np.int8))
