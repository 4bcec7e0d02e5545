"""Rows that hold until the next, as spans of time in a window."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.samples import Array


class Spans(NamedTuple):
    """Spans of time in each of which one row holds.

    Attributes:
        rows: (n, 1 + width), column 0 when each begins to hold in the window [s].
        lasting: (n,) how long it does [s]; 0 of what begins to hold at its very end.
    """

    rows: Array
    lasting: Array


class HeldRows:
    """Cuts the rows of an on-change signal into the spans of a window: one is known when the next row comes.

    Args:
        window: of the spans.
    """

    def __init__(self, window: JudgedWindow) -> None:
        self._window = window
        self._last: Array | None = None

    def take(self, rows: Array) -> Spans:
        """The spans that end with one of more rows (n, 1 + width)."""
        whole = rows if self._last is None else np.concatenate([self._last, rows])
        if not len(whole):
            return Spans(rows, np.zeros(0))
        self._last = whole[-1:].copy()
        return self._cut(whole[:-1], whole[1:, 0])

    def rest(self, end_s: float) -> Spans:
        """The last span, once nothing comes any more and the run has ended [s]."""
        if self._last is None:
            return Spans(np.empty((0, 2)), np.zeros(0))
        last, self._last = self._last, None
        return self._cut(last, np.array([np.inf]), end_s)

    def _cut(self, rows: Array, until: Array, end_s: float = np.inf) -> Spans:
        start, end = self._window.start_s, min(self._window.end_s, end_s)
        chosen = (rows[:, 0] <= end) & (until > start)
        rows, until = rows[chosen].copy(), np.minimum(until[chosen], end)
        rows[:, 0] = np.maximum(rows[:, 0], start)
        return Spans(rows, np.maximum(until - rows[:, 0], 0.0))
