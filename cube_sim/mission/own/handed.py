"""What code of the user's own is given, and what is kept of its answers: the same numbers, in arrays of their own.

Whoever writes into what it was given, or later into what it has answered, then writes into nothing of the flight's.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

Thing = TypeVar("Thing")


def handed(thing: Thing) -> Thing:
    """The same, all arrays in it copied; tuples are gone through, whatever else is in them is handed on as it is."""
    copied: Any = thing
    if isinstance(thing, np.ndarray):
        copied = thing.copy()
    elif isinstance(thing, tuple):
        parts = [handed(part) for part in thing]
        make = getattr(type(thing), "_make", type(thing))  # of a named tuple, or of a plain one
        copied = make(parts)
    return copied
