"""A process that was forked off while threads of its parent flew: what they held locked stays locked in it.

The locks are Python's, numba's and MuJoCo's hooks'; whichever of them a thread held then, the child would wait for it
for ever. So it says no.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from cube_sim.errors import FlightError

_flying: list[int] = []
"""Threads that fly, by their numbers; one may be in it several times."""
_cut_off = False


@contextmanager
def flying() -> Iterator[None]:
    """Around what a thread does to fly."""
    me = threading.get_ident()
    _flying.append(me)
    try:
        yield
    finally:
        _flying.remove(me)


def require_its_own_threads() -> None:
    """Refuse to fly in a child of threads that flew.

    Raises:
        FlightError: this process is one.
    """
    if _cut_off:
        raise FlightError(
            "this process was forked off while other threads of its parent flew, whose locks nobody opens here: fork "
            "before they fly, or start processes by spawn"
        )


def _in_child() -> None:
    """Only the thread that forked lives on here."""
    global _cut_off
    me = threading.get_ident()
    _cut_off = _cut_off or any(thread != me for thread in _flying)
    _flying[:] = [thread for thread in _flying if thread == me]


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_in_child)
