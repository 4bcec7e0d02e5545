"""Combinations of thrusters that are lost, each by its number."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import combinations, islice
from math import comb
from typing import Any


def combination_count(thrusters: Sequence[str], losses: Sequence[int]) -> int:
    """How many there are."""
    return sum(comb(len(thrusters), n) for n in losses)


def combination(thrusters: Sequence[str], losses: Sequence[int], index: int) -> tuple[str, ...]:
    """One of them; fewest losses as `losses` has them, each in the order of the thrusters."""
    for n in losses:
        count = comb(len(thrusters), n)
        if index < count:
            return _of(tuple(thrusters), n, index)
        index -= count
    raise IndexError(index)


@cache
def _of(thrusters: tuple[str, ...], n: int, index: int) -> tuple[str, ...]:
    return next(islice(combinations(thrusters, n), index, None))


def event_of(lost: Sequence[str], at_s: float) -> dict[str, Any]:
    """What the scenario says of it."""
    return {"kind": "thrusters", "at_s": at_s, "thrusters": list(lost), "state": "dead"}
