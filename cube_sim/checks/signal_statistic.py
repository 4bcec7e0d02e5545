"""The check of one statistic of one signal."""

from __future__ import annotations

from collections.abc import Collection
from typing import assert_never

import numpy as np

from cube_sim.checks.judging import Largest, judged
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Array, Samples, Signals, note_not_finite
from cube_sim.scenario.check_blocks import SignalCheckBlock
from cube_sim.verdict import CheckResult


class SignalStatistic:
    """Judges a `SignalCheckBlock`."""

    def __init__(self, check: SignalCheckBlock) -> None:
        self.needs = (check.signal,)
        self._check, self._samples, self._reasons = check, Samples(check.signal), Reasons()
        self._worst, self._inside = Largest(), 0
        self._first = self._last = self._final = np.nan
        self._sum = 0.0

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        check = self._check
        rows = block.get(check.signal)
        if rows is None or not self._samples.take(rows):
            return
        times = rows[:, 0]
        rows = rows[
            (times >= (-np.inf if check.from_s is None else check.from_s))
            & (times <= (np.inf if check.to_s is None else check.to_s))
        ]
        if not len(rows):
            return
        self._first = self._first if self._inside else rows[0, 0]
        self._last, self._inside = rows[-1, 0], self._inside + len(rows)
        component = check.component
        if note_not_finite(self._reasons, check.signal, rows) and (component is None or component + 1 < rows.shape[1]):
            times, values = rows[:, 0], rows[:, 1:]
            if component is not None:
                series = values[:, component]
            else:
                series = values[:, 0] if values.shape[1] == 1 else np.linalg.norm(values, axis=1)
            with np.errstate(over="ignore"):
                self._count(series, times)

    def _count(self, series: Array, times: Array) -> None:
        """Take in values (n,) of the window."""
        statistic, at_most = self._check.statistic, self._check.at_most is not None
        self._final = series[-1]
        match statistic:
            case "rms":
                self._sum = added(self._sum, series**2, times)
                size = np.abs(series)
                self._worst.take(size if at_most else -size, times)
            case "mean":
                self._sum = added(self._sum, series, times)
                self._worst.take(series if at_most else -series, times)
            case "max":
                self._worst.take(series, times)
            case "min":
                self._worst.take(-series, times)
            case "max_abs":
                self._worst.take(np.abs(series), times)
            case "final":
                pass
            case _:
                assert_never(statistic)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        check, samples = self._check, self._samples
        samples.require_every_tick(recorded, duration_s)
        self._require_window()
        self._reasons.require_none(check.signal)
        if check.component is not None and check.component >= samples.width:
            raise NotJudgedError(f"{check.signal} has {samples.width} columns, no component {check.component}")
        value, at_s = self._value()
        detail = f"{self._inside} samples of {check.signal}, {self._first:g} s to {self._last:g} s"
        return judged(check, value, at_s, detail)

    def _require_window(self) -> None:
        check, start, end = self._check, self._samples.start, self._samples.end
        from_s = start if check.from_s is None else check.from_s
        to_s = end if check.to_s is None else check.to_s
        window = f"window {from_s:g} s to {'the end' if check.to_s is None else f'{to_s:g} s'}"
        # Samples stand for the period around them: a window may stick out by one.
        slack = 1.5 * self._samples.period
        if not (start - slack <= from_s <= end + slack and start - slack <= to_s <= end + slack):
            raise NotJudgedError(f"{window} is outside the run, {start:g} s to {end:g} s")
        needed = 1 if check.statistic == "final" else 2
        if self._inside < needed:
            raise NotJudgedError(f"{window} holds {self._inside} samples, needs {needed}")

    def _value(self) -> tuple[float, float]:
        """Value of the statistic, and when the sample was that speaks most against the check [s]."""
        worst, statistic = self._worst, self._check.statistic
        match statistic:
            case "rms":
                return float(np.sqrt(self._sum / self._inside)), worst.at_s
            case "mean":
                return float(self._sum / self._inside), worst.at_s
            case "max" | "max_abs":
                return worst.value, worst.at_s
            case "min":
                return -worst.value, worst.at_s
            case "final":
                return float(self._final), self._last
            case _:
                assert_never(statistic)


def added(total: float, values: Array, times: Array) -> float:
    """A sum and more values (n,), those of each second added up first: blocks of whole seconds give the same bits.

    Args:
        total: of the values before.
        values: in the order of time.
        times: (n,) [s].
    """
    starts = np.flatnonzero(np.diff(np.floor(times), prepend=-np.inf))
    for part in np.add.reduceat(values, starts).tolist():
        total += part
    return total
