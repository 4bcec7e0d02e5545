"""Axes: from numbers to pixels, and where the ticks stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cube_sim.report.decimation import Values
from cube_sim.report.markup import number

_DECADES = 13.0
"""A logarithmic axis shows so many at most; what is smaller lies on its lower edge (choice)."""
_NOISE = 2e-6
"""A spread that is so small a share of the numbers is a level line: six digits of a label would not tell its ends."""


@dataclass(frozen=True)
class Scale:
    """One axis.

    Attributes:
        low: number at its start.
        high: number at its end, above `low`.
        pixels: its length.
        logarithmic: whether equal lengths are equal ratios; `low` is then above 0.
    """

    low: float
    high: float
    pixels: float
    logarithmic: bool = False

    def to_pixels(self, values: Values) -> Values:
        """Pixels from the start of the axis; NaN stays NaN."""
        low, high = self.low, self.high
        if self.logarithmic:
            values = np.log10(np.maximum(values, low))
            low, high = math.log10(low), math.log10(high)
        return (values - low) / (high - low) * self.pixels

    def at(self, value: float) -> float:
        """Pixels of one number, kept on the axis."""
        return min(max(float(self.to_pixels(np.array([value]))[0]), 0.0), self.pixels)

    def ticks(self, wanted: int) -> list[tuple[float, str]]:
        """About so many places of ticks, with their labels."""
        if self.logarithmic:
            first, last = math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9)
            every = max(1, math.ceil((last - first + 1) / wanted))
            return [(10.0**power, number(10.0**power)) for power in range(first, last + 1, every)]
        step = nice_step((self.high - self.low) / max(wanted, 1))
        first = math.ceil(self.low / step - 1e-9)
        places = [index * step for index in range(first, math.floor(self.high / step + 1e-9) + 1)]
        return [(place, number(place, 6)) for place in places]


def nice_step(rough: float) -> float:
    """The step 1, 2 or 5 times a power of ten that is next above a rough one."""
    power = 10.0 ** math.floor(math.log10(rough))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough * (1 - 1e-9))


def scale_for(lowest: float, highest: float, pixels: float, *, logarithmic: bool = False) -> Scale:
    """An axis that shows all from the lowest number to the highest, and a little beyond.

    Args:
        lowest: finite, or NaN where there is nothing to show.
        highest: likewise.
        pixels: its length.
        logarithmic: asked for; a range without a number above 0 has none.
    """
    if not (math.isfinite(lowest) and math.isfinite(highest)):
        return Scale(0.0, 1.0, pixels)
    if logarithmic and highest > 0.0:
        top = highest * 1.6
        return Scale(max(lowest / 1.6, top * 10.0**-_DECADES), top, pixels, True)
    spread = highest - lowest
    if spread <= _NOISE * max(abs(highest), abs(lowest), 1e-9):
        spread = max(abs(highest), 1e-9)
        return Scale(lowest - 0.5 * spread, highest + 0.5 * spread, pixels)
    return Scale(lowest - 0.06 * spread, highest + 0.08 * spread, pixels)
