"""The check that a run differs little from an earlier one."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.judging import Largest, judged
from cube_sim.checks.measured import Measured, clock_of, require_in_run, series_of
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Array, Samples, Signals, note_not_finite
from cube_sim.nearest import counted
from cube_sim.scenario.check_blocks import BaselineCheckBlock
from cube_sim.scenario.statistic_keys import AsksStatistic
from cube_sim.scenario.windows import window_of
from cube_sim.verdict import CheckResult

SAME_INSTANT_S = 1e-6
"""Rows of two runs that are no farther apart are of one instant: times are whole periods but for rounding."""


class StatisticOfBoth:
    """Judges a `BaselineCheckBlock` that names a statistic."""

    def __init__(self, check: BaselineCheckBlock, asked: AsksStatistic, beforehand: Beforehand) -> None:
        self._check, self._asked, self._beforehand = check, asked, beforehand
        self._ours = Measured(
            asked, JudgedWindow(window_of(check, beforehand.events), beforehand), beforehand, at_most=True
        )
        self.needs = self._ours.needs

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._ours.take(block)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        ours = self._ours.found(recorded, duration_s)
        name, rows = self._asked.signal, self._beforehand.baseline(self._check)
        window = self._ours.window_of_other()
        theirs = Measured(self._asked, window, self._beforehand, at_most=True)
        theirs.take({name: rows})
        try:
            other = theirs.found((name,), window.end_s)
        except NotJudgedError as reason:
            raise NotJudgedError(f"in the baseline: {reason}") from None
        detail = f"{ours.value:g}, {other.value:g} in the baseline: {self._ours.detail}"
        return judged(self._check, abs(ours.value - other.value), ours.at_s, detail)


class SignalOfBoth:
    """Judges a `BaselineCheckBlock` of a whole signal: the largest distance of the two, instant by instant."""

    def __init__(self, check: BaselineCheckBlock, beforehand: Beforehand) -> None:
        self._check, self._beforehand, self._reasons = check, beforehand, Reasons()
        self._window = JudgedWindow(window_of(check, beforehand.events), beforehand)
        self._samples, self._clock, self._farthest = Samples(check.signal), Samples(clock_of(check.signal)), Largest()
        self._held = check.signal in beforehand.held
        self._ours: list[Array] = []
        self._instants, self._first, self._last = 0, np.nan, np.nan
        named = (check.signal, self._clock.name) if self._held else (check.signal,)
        self.needs = (*named, *self._window.needs)

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._window.take(block)
        if self._held and self._clock.name in block:
            self._clock.take(block[self._clock.name])
        rows = block.get(self._check.signal)
        if rows is None or not self._samples.take(rows):
            return
        if self._held:
            self._ours.append(rows)
            return
        rows = rows[self._window.inside(rows[:, 0])]
        if len(rows) and note_not_finite(self._reasons, self._check.signal, rows):
            theirs = self._theirs()
            if theirs is not None:
                self._compare(rows, theirs[_nearest(theirs[:, 0], rows[:, 0])])

    def _theirs(self) -> Array | None:
        """The rows of the baseline; None, which is a reason, where there are none."""
        if not self._reasons.none("baseline"):
            return None
        try:
            return self._beforehand.baseline(self._check)
        except NotJudgedError as reason:
            self._reasons.note("baseline", str(reason))
            return None

    def _compare(self, ours: Array, theirs: Array) -> None:
        """Hold rows (n, 1 + width) of the same instants against one another."""
        name, component = self._check.signal, self._check.component
        if ours.shape != theirs.shape:
            text = f"{name} has {ours.shape[1] - 1} columns, {theirs.shape[1] - 1} in the baseline"
            self._reasons.note("width", text)
            return
        if component is not None and component + 1 >= ours.shape[1]:
            self._reasons.note("width", f"{name} has {counted(ours.shape[1] - 1, 'column')}, no component {component}")
            return
        apart = np.flatnonzero(~(np.abs(ours[:, 0] - theirs[:, 0]) <= SAME_INSTANT_S))
        if len(apart):
            self._reasons.note("times", f"the baseline has no row of {name} at {ours[apart[0], 0]:g} s")
            return
        note_not_finite(self._reasons, name, theirs)
        self._first = self._first if self._instants else ours[0, 0]
        self._last, self._instants = ours[-1, 0], self._instants + len(ours)
        with np.errstate(over="ignore", invalid="ignore"):
            distance = np.abs(series_of(ours[:, 1:] - theirs[:, 1:], component, self._check.combine))
        self._farthest.take(distance, ours[:, 0])

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        name, clock = self._check.signal, self._clock if self._held else self._samples
        if self._held:
            self._samples.require(recorded)
        clock.require_every_tick(recorded, duration_s)
        require_in_run(self._window.shown(clock.end), clock.start, clock.end, 1.5 * clock.period)
        if self._held and not self._instants:
            self._compare_held(max(self._window.start_s, clock.start), min(self._window.end_s, clock.end))
        for kind in ("baseline", name, "width", "times"):
            self._reasons.require_none(kind)
        if not self._instants:
            raise NotJudgedError("the window holds no instant of both runs")
        detail = f"{self._instants} instants of {name} in both runs, {self._first:g} s to {self._last:g} s"
        return judged(self._check, self._farthest.value, self._farthest.at_s, detail)

    def _compare_held(self, start: float, end: float) -> None:
        """What holds from the start of the window [s] to its end, at each change of either."""
        ours, theirs = np.concatenate(self._ours), self._theirs()
        if theirs is None:
            return
        for rows in (ours, theirs):
            if not rows[0, 0] <= start:
                whose = "in the baseline " if rows is theirs else ""
                self._reasons.note("times", f"{self._check.signal} {whose}starts at {rows[0, 0]:g} s, not {start:g} s")
                return
        times = np.unique(np.concatenate([[start], ours[:, 0], theirs[:, 0]]))
        times = times[(times >= start) & (times <= end)]
        both = [rows[np.searchsorted(rows[:, 0], times, side="right") - 1].copy() for rows in (ours, theirs)]
        for rows in both:
            rows[:, 0] = times
        if note_not_finite(self._reasons, self._check.signal, both[0]):
            self._compare(*both)


def _nearest(known: Array, times: Array) -> NDArray[np.intp]:
    """Which of known times (k,) is nearest to each of others (n,)."""
    after = np.clip(np.searchsorted(known, times), 1, max(len(known) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(known) - 1)
    return np.where(times - known[before] <= known[after] - times, before, after)
