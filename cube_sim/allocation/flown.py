"""An allocator as the loop of a flight asks it: by the addresses of compiled code."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class SearchCodes(NamedTuple):
    """Addresses of machine code.

    Attributes:
        search: of `solve_each`.
        instead: of what answers in its place, `cube_sim.allocation.exact.fewest_calls.solve_in_reach` under a change
            limit or a baseline; 0 for nothing.
        travel: of `cube_sim.allocation.exact.fewest_calls.travel_in_reach`, under a change limit.
    """

    search: int
    instead: int
    travel: int


class FlownAllocator(NamedTuple):
    """An allocator as the loop of a flight asks it, in compiled code.

    Those of cube_sim give it by their method ``flown``, told whether demands have a part that gives way; None from one
    that only Python asks.

    Attributes:
        packed: all that it answers by and remembers, for the code.
        codes: finds out where the code lies, and compiles it where there is none.
        answer_size: numbers in one answer.
        add_effort: tells it of what the code has done: nodes looked at, and answers not proven.
        confirms: whether it looks at each answer afterwards.
        confirm: hands on answers (N, `answer_size`), and the demands (N, n) that they answer.
        go_on_confirming: looks at them beside what the caller does next, which leaves Python to others.
    """

    packed: NDArray[np.float64]
    codes: Callable[[], SearchCodes]
    answer_size: int
    add_effort: Callable[[int, int], None]
    confirms: bool
    confirm: Callable[[NDArray[np.float64], NDArray[np.float64]], None]
    go_on_confirming: Callable[[], None] = lambda: None
