"""What there is, in the words of an error: all of a few names, the nearest of many."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches

FEW = 8
NEAREST = 3


def counted(number: int, noun: str) -> str:
    """``1 value``, ``2 values``."""
    return f"{number} {noun}{'s' * (number != 1)}"


def among(name: str, known: Collection[str]) -> str:
    """``a, b, c`` of a few names; ``40, the nearest a, b, c`` of many.

    Args:
        name: that is not among them.
        known: in the order in which a few are told.
    """
    if len(known) <= FEW:
        return ", ".join(known) or "none"
    by_lower = {each.lower(): each for each in reversed([*known])}
    near = get_close_matches(name.lower(), by_lower, n=NEAREST, cutoff=0.0)
    return f"{len(known)}, the nearest {', '.join(by_lower[each] for each in near)}"
