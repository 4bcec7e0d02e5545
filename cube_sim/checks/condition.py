"""The checks that a condition on signals holds always, or once."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.judging import Largest, judged
from cube_sim.checks.measured import clock_of, require_in_run, series_of
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Array, Samples, Signals, taken_away
from cube_sim.nearest import counted
from cube_sim.scenario.check_blocks import AlwaysCheckBlock, ComparisonBlock, EventuallyCheckBlock
from cube_sim.scenario.check_windows import condition_window
from cube_sim.verdict import CheckResult


class ConditionHolds:
    """Judges an `AlwaysCheckBlock` or an `EventuallyCheckBlock`.

    The margin of a comparison at an instant is the distance of its signal from the limit, negative beyond it, over its
    scale. That of all comparisons is the smallest of theirs, that of any the largest; always is the smallest over time,
    eventually the largest. Instants are those at which any of the signals has a row, and each holds until its next.
    """

    def __init__(self, check: AlwaysCheckBlock | EventuallyCheckBlock, beforehand: Beforehand) -> None:
        self._check, self._reasons = check, Reasons()
        self._always = isinstance(check, AlwaysCheckBlock)
        self._alone = len(check.comparisons) == 1 and not check.scaled
        self._window = JudgedWindow(condition_window(check, beforehand.events), beforehand)
        named = tuple(dict.fromkeys(each.signal for each in check.named_signals))
        self._signals = [_Followed(each) for each in check.comparisons]
        self._on_change = {each.signal for each in check.comparisons if each.signal in beforehand.held}
        self._clock = Samples(clock_of(min(self._on_change, default=named[0])))
        self._decisive, self._instants, self._began = Largest(), 0, False
        self._first = self._last = self._turned_s = np.nan
        clock = (self._clock.name,) if self._on_change else ()
        self.needs = tuple(dict.fromkeys((*named, *clock, *self._window.needs)))

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._window.take(block)
        if self._on_change and self._clock.name in block:
            self._clock.take(block[self._clock.name])
        none = np.empty((0, 2))
        known = [
            each.take(block.get(each.asked.signal, none), self._other(block, each), self._reasons)
            for each in self._signals
        ]
        times = np.unique(np.concatenate(known))
        times = times[np.isfinite(times)]
        start = self._window.start_s
        if self._on_change and not self._began and self._clock_or(times) >= start:
            times = np.union1d(times, [start]) if np.isfinite(start) else times
            self._began = True
        self._look_at(times)
        for each in self._signals:
            each.forget()

    def _other(self, block: Signals, each: _Followed) -> Array | None:
        """Rows of what is taken away from a signal; None where nothing is."""
        return None if each.asked.minus is None else block.get(each.asked.minus, np.empty((0, 2)))

    def _clock_or(self, times: Array) -> float:
        """How far the run has come [s]."""
        last = float(times[-1]) if len(times) else -np.inf
        return max(last, self._clock.end) if len(self._clock) else last

    def _look_at(self, times: Array) -> None:
        """Take in instants (n,) [s], those of them in the window, once each signal has a value."""
        times = times[self._inside(times)]
        times = times[times >= max(each.begins for each in self._signals)] if len(times) else times
        if not len(times):
            return
        series = [each.at(times, self._reasons) for each in self._signals]
        self._first = self._first if self._instants else float(times[0])
        self._last, self._instants = float(times[-1]), self._instants + len(times)
        with np.errstate(over="ignore", invalid="ignore"):
            margins = np.array([margin_of(*both) for both in zip(self._check.comparisons, series, strict=True)])
        margin = margins.min(axis=0) if self._check.all else margins.max(axis=0)
        turned = np.flatnonzero(~(margin >= 0) if self._always else margin >= 0)
        if len(turned) and np.isnan(self._turned_s):
            self._turned_s = float(times[turned[0]])
        if self._alone:
            margin = series[0] if self._check.bound.relation == ">=" else -series[0]
        self._decisive.take(-margin if self._always else margin, times)

    def _inside(self, times: Array) -> NDArray[np.bool_]:
        """Which of some instants (n,) [s] are in the window; what is held alone has its start as well."""
        if self._on_change and len(self._on_change) == len({each.asked.signal for each in self._signals}):
            return (times >= self._window.start_s) & (times <= self._window.end_s)
        return self._window.inside(times)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        begins, ends, slack = -np.inf, np.inf, 0.0
        for each in self._signals:
            samples = each.samples
            if each.asked.signal not in self._on_change:
                samples.require_every_tick(recorded, duration_s)
                begins, ends = max(begins, samples.start), min(ends, samples.end)
                slack = max(slack, 1.5 * samples.period)
            else:
                samples.require(recorded)
            if each.asked.component is not None and each.asked.component >= samples.width:
                text = f"{samples.name} has {counted(samples.width, 'column')}, no component {each.asked.component}"
                raise NotJudgedError(text)
        if self._on_change and self._clock.name in recorded:
            self._clock.require_every_tick(recorded, duration_s)
            begins, ends = max(begins, self._clock.start), min(ends, self._clock.end)
            slack = max(slack, 1.5 * self._clock.period)
        window = self._window.shown(ends)
        if np.isfinite(begins) and np.isfinite(ends):
            require_in_run(window, begins, ends, slack)
        for each in self._signals:
            start = begins if window.start_s is None else window.start_s
            if each.asked.signal in self._on_change and each.samples.start > start:
                text = f"{each.asked.signal} starts at {each.samples.start:g} s, the window at {start:g} s"
                raise NotJudgedError(text)
        for named in self._check.named_signals:
            if named.signal not in recorded:
                raise NotJudgedError(f"no signal {named.signal}")
        self._reasons.require_none("minus")
        for each in self._signals:
            self._reasons.require_none(each.asked.signal)
        if not self._instants:
            raise NotJudgedError("the window holds no instant at which every signal has a value")
        worst = -self._decisive.value if self._always else self._decisive.value
        value = -worst if self._alone and self._check.bound.relation == "<=" else worst
        return judged(self._check, value, self._decisive.at_s, self._detail())

    def _detail(self) -> str:
        seen = f"{self._instants} instants, {self._first:g} s to {self._last:g} s"
        if np.isnan(self._turned_s):
            return seen
        return f"{seen}; first {'violated' if self._always else 'holds'} at {self._turned_s:g} s"


class _Followed:
    """One signal of the condition, and the last of its rows."""

    def __init__(self, asked: ComparisonBlock) -> None:
        self.asked, self.samples = asked, Samples(asked.signal)
        self._rows = np.empty((0, 2))
        self.begins = np.inf

    def take(self, rows: Array, other: Array | None, reasons: Reasons) -> Array:
        """Take in more rows, and those that are taken away from them; their times."""
        if not self.samples.take(rows):
            return np.zeros(0)
        if other is not None:
            less = taken_away(rows, other, (self.asked.signal, str(self.asked.minus)), reasons)
            if less is None:
                return np.zeros(0)
            rows = less
        self.begins = min(self.begins, self.samples.start)
        self._rows = np.concatenate([self._rows, rows]) if len(self._rows) else rows
        return rows[:, 0]

    def at(self, times: Array, reasons: Reasons) -> Array:
        """The number (n,) in force at instants (n,) [s]; one that is not finite is a reason."""
        component = self.asked.component
        index = np.maximum(np.searchsorted(self._rows[:, 0], times, side="right") - 1, 0)
        if component is not None and component + 1 >= self._rows.shape[1]:
            return np.full(len(times), np.nan)
        found = self._rows[index, 1:]
        bad = ~np.isfinite(found).all(axis=1)
        if bad.any():
            reasons.note(self.asked.signal, f"{self.asked.signal} is not finite at {times[int(np.argmax(bad))]:g} s")
        return series_of(found, component, self.asked.combine)

    def forget(self) -> None:
        """Keep the last row alone."""
        self._rows = self._rows[-1:].copy()


def margin_of(asked: ComparisonBlock, series: Array) -> Array:
    """How far numbers (n,) are from the limit of a comparison, negative beyond it, over its scale."""
    relation, limit = asked.bound
    distance = limit - series if relation == "<=" else series - limit
    return distance if asked.scale is None else distance / asked.scale
