"""One statistic of one signal over one window, block by block."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.held_rows import HeldRows
from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.reasons import NotJudgedError, Reasons
from cube_sim.checks.samples import Array, Samples, Signals, note_not_finite, taken_away
from cube_sim.checks.statistics import MeasuredValue, accumulator
from cube_sim.nearest import counted
from cube_sim.scenario.statistic_keys import AsksStatistic, Combining
from cube_sim.scenario.windows import TimeWindow

_CLOCK = "pose.position"


class Measured:
    """Finds a statistic.

    Args:
        asked: which, of which signal.
        window: in which.
        beforehand: what is known of the run.
        at_most: whether large values speak against the check; else small ones do.
        limit: of the statistic itself; None where it is one of several numbers that make the value.
    """

    def __init__(
        self,
        asked: AsksStatistic,
        window: JudgedWindow,
        beforehand: Beforehand,
        at_most: bool,
        limit: float | None = None,
    ) -> None:
        self._asked, self._window, self._reasons = asked, window, Reasons()
        self._samples, self._clock = Samples(asked.signal), Samples(clock_of(asked.signal))
        self._held = HeldRows(window) if asked.signal in beforehand.held else None
        self._found = accumulator(asked, at_most, limit)
        self._inside, self._first, self._last = 0, np.nan, np.nan
        self._minus = None if asked.minus is None else Samples(asked.minus)
        named = *((asked.signal,) if asked.minus is None else (asked.signal, asked.minus)), *self._window.needs
        self.needs = named if self._held is None else (*named, self._clock.name)

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._window.take(block)
        rows = block.get(self._asked.signal)
        if self._held is not None and self._clock.name in block:
            self._clock.take(block[self._clock.name])
        if rows is None or not self._samples.take(rows):
            return
        if self._asked.minus is not None and self._minus is not None:
            other = block.get(self._asked.minus, np.empty((0, 2)))
            self._minus.take(other)
            less = taken_away(rows, other, (self._asked.signal, self._asked.minus), self._reasons)
            if less is None:
                return
            rows = less
        if self._held is not None:
            spans = self._held.take(rows)
            self._take_in(spans.rows, spans.lasting)
            return
        self._take_in(rows[self._window.inside(rows[:, 0])])

    def _take_in(self, rows: Array, lasting: Array | None = None) -> None:
        """Take in rows of the window (n, 1 + width), and how long they last where they are held."""
        if not len(rows):
            return
        component = self._asked.component
        self._first = self._first if self._inside else rows[0, 0]
        self._last, self._inside = rows[-1, 0], self._inside + len(rows)
        sound = note_not_finite(self._reasons, self._asked.signal, rows)
        if not sound or (component is not None and component + 1 >= rows.shape[1]):
            return
        if self._asked.statistic == "changes" and component is None:
            series = rows[:, 1:]  # a vector that turns changes, though its norm does not
        else:
            series = series_of(rows[:, 1:], component, self._asked.combine)
        with np.errstate(over="ignore", invalid="ignore"):
            self._found.take(series, rows[:, 0], lasting)

    def found(self, recorded: Collection[str], duration_s: float | None) -> MeasuredValue:
        """The statistic, once nothing comes any more.

        Args:
            recorded: the names of all signals.
            duration_s: how long the run should have been; None if nothing is known of that.

        Raises:
            NotJudgedError: it cannot be told.
        """
        if self._minus is not None:
            self._samples.require(recorded)
            self._minus.require(recorded)
            self._reasons.require_none("minus")
        if self._held is None:
            self._samples.require_every_tick(recorded, duration_s)
            start, end = self._samples.start, self._samples.end
            window = self._window.shown(end)
            require_in_run(window, start, end, 1.5 * self._samples.period)
            self._require_samples(1 if self._asked.statistic == "final" else 2, window)
            start, end = self._first, self._last
        else:
            start, end, window = self._held_window(recorded, duration_s, self._held)
        self._reasons.require_none(self._asked.signal)
        component, width = self._asked.component, self._samples.width
        if component is not None and component >= width:
            raise NotJudgedError(f"{self._asked.signal} has {counted(width, 'column')}, no component {component}")
        if self._asked.statistic == "settling" and window.start_s is not None:
            start = window.start_s
        with np.errstate(over="ignore", invalid="ignore"):
            return self._found.found(start, end)

    def _held_window(
        self, recorded: Collection[str], duration_s: float | None, held: HeldRows
    ) -> tuple[float, float, TimeWindow]:
        """Take in what holds at the end; from when to when the window really is [s], and the window."""
        name, samples, clock = self._asked.signal, self._samples, self._clock
        samples.require(recorded)
        begins, ends = samples.start, samples.end
        if clock.name in recorded:
            clock.require_every_tick(recorded, duration_s)
            begins, ends = clock.start, clock.end
        elif duration_s is not None:
            ends = duration_s
        window = self._window.shown(ends)
        if clock.name in recorded:
            require_in_run(window, begins, ends, 1.5 * clock.period)
        spans = held.rest(ends)
        self._take_in(spans.rows, spans.lasting)
        start = begins if window.start_s is None else max(window.start_s, begins)
        end = ends if window.end_s is None else min(window.end_s, ends)
        if samples.start > start:
            raise NotJudgedError(f"{name} starts at {samples.start:g} s, the window at {start:g} s")
        self._first, self._last = start, end
        return start, end, window

    def _require_samples(self, needed: int, window: TimeWindow) -> None:
        if self._inside < needed:
            words = _words(window, self._samples.start)
            raise NotJudgedError(f"{words} holds {self._inside} samples, needs {needed}")

    def window_of_other(self) -> JudgedWindow:
        """That of another run, which is to be looked at for as long as this one, once this one is over."""
        last = float(self._last)
        return self._window.of_other(last)

    @property
    def detail(self) -> str:
        """What was looked at, for readers."""
        less = "" if self._asked.minus is None else f" - {self._asked.minus}"
        what = f"{self._inside} samples of {self._asked.signal}{less}"
        if self._held is not None:
            what = f"{self._inside} values of {self._asked.signal}, each held until the next"
        return f"{what}, {self._first:g} s to {self._last:g} s"


def clock_of(signal: str) -> str:
    """A signal of every tick, of the same vehicle: how far the run goes where rows of one come with a change only."""
    vehicle, among, _ = signal.rpartition("/")
    return f"{vehicle}{among}{_CLOCK}"


def series_of(values: Array, component: int | None, combine: Combining) -> Array:
    """One number (n,) of each sample (n, width): a component, the only column, or what is combined of several."""
    if component is not None:
        return values[:, component]
    if values.shape[1] == 1:
        return values[:, 0]
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows is seen to be no number
        if combine != "sum":
            return np.linalg.norm(values if combine == "norm" else values[:, :2], axis=1)
        total = np.zeros(len(values))
        for column in range(values.shape[1]):  # in one order on every machine
            total += values[:, column]
        return total


def require_in_run(window: TimeWindow, start: float, end: float, slack: float) -> None:
    """Require that a window lies in a run; samples stand for the period around them: it may stick out by one.

    Args:
        window: of the check.
        start: of the run [s].
        end: of it [s].
        slack: by so much.

    Raises:
        NotJudgedError: it does not.
    """
    from_s = start if window.start_s is None else window.start_s
    to_s = end if window.end_s is None else window.end_s
    if not (start - slack <= from_s <= end + slack and start - slack <= to_s <= end + slack):
        raise NotJudgedError(f"{_words(window, start)} is outside the run, {start:g} s to {end:g} s")


def _words(window: TimeWindow, start: float) -> str:
    from_s = start if window.start_s is None else window.start_s
    return f"window {from_s:g} s to {'the end' if window.end_s is None else f'{window.end_s:g} s'}"
