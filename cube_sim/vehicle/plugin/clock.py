"""MuJoCo's clock, held still while compiled code flies: Python's bindings give it one, for `mjData.timer`.

It is looked at some thirty times in each evaluation of the dynamics, which is a fifth of their time; nobody reads what
it says of a flight.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import NamedTuple

import llvmlite.binding as llvm

from cube_sim.native import object_cache

_CODE = """
@cube_sim_stands_at = global double 0.0
define double @cube_sim_still_clock() {
  %time = load double, ptr @cube_sim_stands_at
  ret double %time
}
"""
_lock = threading.Lock()
_users = 0
_before: int | None = None
_libraries: list[str] = []


class _StillClock(NamedTuple):
    """MuJoCo's variable that holds the address of its clock, our clock's address, what it says, and who owns its code.

    It is a clock of its own rather than none: a thread that steps something else may be about to call it.
    """

    held: ctypes.c_void_p
    address: int
    stands_at: ctypes.c_double
    engine: object


def publish(library: str) -> None:
    """Say which file of MuJoCo's is loaded."""
    _libraries[:] = [library]


@contextmanager
def held_still() -> Iterator[None]:
    """While this lasts, MuJoCo's clock stands still, in the whole process; `mjData.timer` counts no durations."""
    global _users, _before
    if not _libraries:
        yield
        return
    with _lock:
        clock = _still_clock()  # one for all threads: the code of another would be freed while MuJoCo runs it
        if _users == 0:
            _before = clock.held.value
            if _before is not None:
                clock.stands_at.value = ctypes.CFUNCTYPE(ctypes.c_double)(_before)()
                clock.held.value = clock.address
        _users += 1
    try:
        yield
    finally:
        with _lock:
            _users -= 1
            if _users == 0 and clock.held.value == clock.address:  # else somebody has set another meanwhile
                clock.held.value = _before


@cache
def _still_clock() -> _StillClock:
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(_CODE), object_cache.machine())
    engine.finalize_object()
    return _StillClock(
        ctypes.c_void_p.in_dll(ctypes.CDLL(_libraries[0]), "mjcb_time"),
        engine.get_function_address("cube_sim_still_clock"),
        ctypes.c_double.from_address(engine.get_global_value_address("cube_sim_stands_at")),
        engine,
    )
