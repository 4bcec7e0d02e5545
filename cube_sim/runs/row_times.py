"""When a channel has rows, and when not."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.batch import Rows

Span = tuple[float, float]


class RowTimes:
    """Takes in the times of rows, one part after another, and keeps no more than their number and their gaps.

    Args:
        period_s: between two rows [s].

    Attributes:
        rows: how many there are.
        last_s: time of the last one [s]; 0 without rows.
    """

    def __init__(self, period_s: float) -> None:
        self.rows, self.last_s = 0, 0.0
        self._period_s, self._first_s = period_s, 0.0
        self._gaps: list[Span] = []  # between the times of two rows [s]

    def take(self, times: NDArray[np.float64]) -> None:
        """Take in the times that come next, (n,) [s], increasing."""
        if not len(times):
            return
        if self.rows:
            times = np.concatenate([[self.last_s], times])
            self.rows -= 1
        else:
            self._first_s = float(times[0])
        self.rows, self.last_s = self.rows + len(times), float(times[-1])
        gaps = np.flatnonzero(np.diff(times) > 1.5 * self._period_s)
        self._gaps += zip(times[gaps].tolist(), times[gaps + 1].tolist(), strict=True)

    def spans_without_rows(self, end_s: float) -> tuple[Span, ...]:
        """From when to when there are no rows [s].

        Args:
            end_s: when the last one should be [s].
        """
        # A row stands for the period that it begins; the last one is the state at the end.
        period = self._period_s
        gaps = [(-period, end_s + period)]
        if self.rows:
            gaps = [(-period, self._first_s), *self._gaps, (self.last_s, end_s + period)]
        return tuple((start + period, min(end, end_s)) for start, end in gaps if end - start > 1.5 * period)


def row_times_of(rows: Mapping[str, Rows], period_s: float) -> dict[str, RowTimes]:
    """When each channel has rows.

    Args:
        rows: of each, (n, 1+width), column 0 the time [s].
        period_s: the control period [s].
    """
    found = {name: RowTimes(period_s) for name in rows}
    for name, some in rows.items():
        found[name].take(some[:, 0])
    return found
