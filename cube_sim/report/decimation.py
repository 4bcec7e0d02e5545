"""Which samples of a curve are drawn: enough for the screen, and no peak is lost."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
Positions = NDArray[np.intp]


def decimated(places: Values, values: Values, columns: int, tolerance: float = 0.0) -> Iterator[Positions]:
    """The samples to draw: of each column of pixels the first, the lowest, the highest and the last.

    Args:
        places: (n,) where on the axis, in columns, increasing.
        values: (n,); NaN and infinities are gaps.
        columns: how many there are; samples outside 0 to `columns` are left out.
        tolerance: a column whose values differ by no more than this keeps its highest only.

    Yields:
        For each unbroken stretch the positions (k,) of its samples, increasing. The lowest and the highest of the
        stretch are always among them.
    """
    sound = np.isfinite(values) & (places >= -1e-9) & (places <= columns + 1e-9)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], sound, [False]])))
    for start, stop in edges.reshape(-1, 2).tolist():
        yield start + _of_stretch(np.floor(places[start:stop]), values[start:stop], tolerance)


def _of_stretch(column: Values, values: Values, tolerance: float) -> Positions:
    begins = np.flatnonzero(np.concatenate([[True], np.diff(column) > 0]))
    lowest, highest = np.minimum.reduceat(values, begins), np.maximum.reduceat(values, begins)
    group = np.repeat(np.arange(len(begins)), np.diff(np.append(begins, len(values))))
    at_highest = _first(values == highest[group], group)
    moving = highest - lowest > tolerance
    at_lowest = _first(values == lowest[group], group)[moving]
    ends = (np.append(begins[1:], len(values)) - 1)[moving]
    whole = [0, len(values) - 1, int(np.argmin(values)), int(np.argmax(values))]
    return np.unique(np.concatenate([at_highest, at_lowest, begins[moving], ends, whole]))


def _first(chosen: NDArray[np.bool_], group: Positions) -> Positions:
    """The first chosen position of each group."""
    positions = np.flatnonzero(chosen)
    return positions[np.unique(group[positions], return_index=True)[1]]


def stepped(times: Values, values: Values, until: float) -> tuple[Values, Values]:
    """A value that holds until the next, as the corners of its steps, the last one held until a time."""
    if not len(times):
        return times, values
    at = np.append(np.repeat(times, 2)[1:], max(until, float(times[-1])))
    return at, np.repeat(values, 2)


def held(rows: Values, times: Values) -> Values:
    """Rows (n, 1+width) that hold until the next, at other times (k,): (k, width); NaN before the first."""
    index = np.searchsorted(rows[:, 0], times, side="right") - 1
    found = rows[np.maximum(index, 0), 1:].copy() if len(rows) else np.full((len(times), rows.shape[1] - 1), np.nan)
    found[index < 0] = np.nan
    return found
