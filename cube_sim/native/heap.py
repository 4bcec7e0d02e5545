"""The memory that a run gets and gives back: by the C library, where that is glibc, and by Python."""

from __future__ import annotations

import ctypes
import gc
import sys
from contextlib import suppress

LARGE_BYTES = 65536
"""Pieces of memory from this size on are the system's, and back there when they are freed (a choice)."""
ARENAS = 2
"""Threads share so many heaps: each of its own would keep what it once needed (a choice)."""

NEW_OBJECTS = 50_000
"""So many are made before Python looks for circles among them; 700 unless it is told otherwise (a choice)."""

_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8  # of malloc.h


def keep_little() -> None:
    """From now on memory that is freed goes back to the system early; elsewhere than with glibc nothing changes."""
    if not sys.platform.startswith("linux"):
        return
    with suppress(OSError, AttributeError):
        mallopt = ctypes.CDLL(None).mallopt
        for option, value in (
            (_MMAP_THRESHOLD, LARGE_BYTES),
            (_TRIM_THRESHOLD, LARGE_BYTES),
            (_ARENA_MAX, ARENAS),
        ):
            mallopt(option, value)


def seldom_look_for_circles() -> None:
    """From now on Python looks for garbage that refers to itself once for every `NEW_OBJECTS`.

    Starting up makes a hundred thousand objects that stay, and looks at them again and again.
    """
    gc.set_threshold(NEW_OBJECTS)
