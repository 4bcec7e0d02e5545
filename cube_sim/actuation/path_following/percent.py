"""Shares in words: a share short of one never reads 100 %."""

from __future__ import annotations

import math

_LEAST = 0.01


def percent(share: float) -> str:
    """A share in percent, rounded down: whole numbers from 10 on, two digits below.

    Args:
        share: finite, not negative.
    """
    value = 100.0 * share
    if 0.0 < value < _LEAST:
        return f"less than {_LEAST:g} %"
    decimals = 0 if value >= 10.0 or value == 0.0 else 1 if value >= 1.0 else 2
    return f"{math.floor(value * 10**decimals) / 10**decimals:.{decimals}f} %"
