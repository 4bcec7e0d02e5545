"""Sums that are the same to the bit however the rows come in blocks: those of each second are added up first."""

from __future__ import annotations

import numpy as np

from cube_sim.checks.samples import Array


class WholeSeconds:
    """Cuts rows anew into seconds: of a second that may go on, the rows wait."""

    def __init__(self) -> None:
        self._waiting: Array | None = None

    def take(self, rows: Array) -> Array:
        """The rows (n, 1 + k) of the seconds that are over, once the next rows are there; column 0 is the time [s]."""
        if self._waiting is not None:
            rows = np.concatenate([self._waiting, rows])
        if not len(rows):
            return rows
        seconds = np.floor(rows[:, 0])
        over = int(np.searchsorted(seconds, seconds[-1]))
        self._waiting = rows[over:].copy()
        return rows[:over]

    def rest(self) -> Array:
        """The rows that wait, once nothing comes any more."""
        rows, self._waiting = self._waiting, None
        return np.empty((0, 2)) if rows is None else rows


class SumBySecond:
    """The sum of many values."""

    def __init__(self) -> None:
        self._seconds, self._total = WholeSeconds(), 0.0

    def take(self, values: Array, times: Array) -> None:
        """Take in more values (n,), in the order of their times (n,) [s]."""
        self._add(self._seconds.take(np.column_stack([times, values])))

    def total(self) -> float:
        """Of all of them."""
        self._add(self._seconds.rest())
        return self._total

    def _add(self, rows: Array) -> None:
        if len(rows):
            for part in np.add.reduceat(np.ascontiguousarray(rows[:, 1]), second_starts(rows)).tolist():
                self._total += part


class SpreadBySecond:
    """Mean and variance of many values, each with a weight: of each second first, then joined.

    Two parts of weights W_a, W_b, means m_a, m_b and sums of squared deviations S_a, S_b make (Chan, Golub and LeVeque
    1979) m = m_a + d W_b / W and S = S_a + S_b + d^2 W_a W_b / W, with d = m_b - m_a and W = W_a + W_b.
    """

    def __init__(self) -> None:
        self._seconds = WholeSeconds()
        self._weight = self._mean = self._squares = 0.0

    def take(self, values: Array, times: Array, weights: Array) -> None:
        """Take in more values (n,), in the order of their times (n,) [s], with their weights (n,)."""
        self._join(self._seconds.take(np.column_stack([times, values, weights])))

    def variance(self) -> float:
        """Of all of them; NaN where they weigh nothing."""
        self._join(self._seconds.rest())
        return self._squares / self._weight if self._weight > 0 else np.nan

    def _join(self, rows: Array) -> None:
        if not len(rows):
            return
        values, weights = np.ascontiguousarray(rows[:, 1]), np.ascontiguousarray(rows[:, 2])
        starts = second_starts(rows)
        sizes = np.diff(np.append(starts, len(rows)))
        total = np.add.reduceat(weights, starts)
        sound = np.where(total > 0, total, 1.0)
        mean = np.add.reduceat(weights * values, starts) / sound
        squares = np.add.reduceat(weights * (values - np.repeat(mean, sizes)) ** 2, starts)
        for w, m, s in zip(total.tolist(), mean.tolist(), squares.tolist(), strict=True):
            if w > 0:
                whole, apart = self._weight + w, m - self._mean
                self._squares += s + apart * apart * (self._weight * w / whole)
                self._mean += apart * (w / whole)
                self._weight = whole


def second_starts(rows: Array) -> np.ndarray:
    """Where in rows (n, 1 + k) each second begins, column 0 being the time [s]."""
    return np.flatnonzero(np.diff(np.floor(rows[:, 0]), prepend=-np.inf))
