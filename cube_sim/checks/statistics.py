"""Statistics of one series of numbers that comes part after part."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol, assert_never

import numpy as np
from numpy.typing import NDArray

from cube_sim.checks.judging import Largest
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.checks.samples import Array
from cube_sim.checks.whole_seconds import SpreadBySecond, SumBySecond
from cube_sim.scenario.statistic_keys import AsksStatistic

Marks = NDArray[np.bool_]


class MeasuredValue(NamedTuple):
    """What was found.

    Attributes:
        value: of the statistic.
        at_s: when it was decided, or when the sample was that speaks most against the limit [s].
    """

    value: float
    at_s: float


class Accumulator(Protocol):
    """Finds one statistic."""

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        """Take in more of the series.

        Args:
            series: (n,) numbers, or (n, width) where all columns count.
            times: (n,) when each is, or begins to hold [s].
            lasting: (n,) how long each holds [s]; None for samples, of which each stands for as much as any other.
        """
        ...

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        """The statistic, once nothing comes any more.

        Args:
            start_s: of the window [s].
            end_s: of it.

        Raises:
            NotJudgedError: what came does not tell.
        """
        ...


def accumulator(asked: AsksStatistic, at_most: bool, limit: float | None = None) -> Accumulator:
    """What finds a statistic.

    Args:
        asked: which.
        at_most: whether large values speak against the limit; else small ones do.
        limit: of the statistic itself; None where it is one of several numbers that make the value.
    """
    worst = _Worst(at_most)
    level = np.nan if asked.level is None else asked.level
    low, high = asked.band or (np.nan, np.nan)
    match asked.statistic:
        case "max":
            return _Extreme(lambda x: x, 1.0)
        case "min":
            return _Extreme(lambda x: x, -1.0)
        case "max_abs":
            return _Extreme(np.abs, 1.0)
        case "min_abs":
            return _Extreme(np.abs, -1.0)
        case "mean":
            return _Mean(worst)
        case "rms":
            return _RootMeanSquare(worst)
        case "std":
            return _StandardDeviation(worst)
        case "percentile":
            return _Percentile(worst, 100.0 if asked.percent is None else asked.percent)
        case "share_above":
            return _Share(worst, lambda x: x > level, lambda x: x)
        case "share_below":
            return _Share(worst, lambda x: x < level, lambda x: -x)
        case "share_within":
            return _Share(worst, lambda x: (x >= low) & (x <= high), lambda x: -np.maximum(low - x, x - high))
        case "crossings":
            return _Count(at_most, lambda x: x >= level)
        case "changes":
            return _Count(at_most, lambda x: x)
        case "settling":
            return _Settling(low, high, at_most, limit)
        case "integral":
            return _Integral(worst)
        case "increase":
            return _Increase()
        case "final":
            return _Final()
        case _:
            assert_never(asked.statistic)


class _Worst:
    """The number that speaks most against the limit."""

    def __init__(self, at_most: bool) -> None:
        self._largest, self._sign = Largest(), 1.0 if at_most else -1.0

    def take(self, badness: Array, times: Array) -> None:
        """Take in numbers of which large ones make the statistic large."""
        self._largest.take(self._sign * badness, times)

    @property
    def at_s(self) -> float:
        """Its time [s]."""
        return self._largest.at_s


class _Extreme:
    def __init__(self, of: Callable[[Array], Array], sign: float) -> None:
        self._of, self._sign, self._largest = of, sign, Largest()

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        self._largest.take(self._sign * self._of(series), times)

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(self._sign * self._largest.value, self._largest.at_s)


class _Weight:
    """How many samples there are, or how long they last."""

    def __init__(self) -> None:
        self._count, self._lasting = 0, SumBySecond()

    def take(self, times: Array, lasting: Array | None) -> None:
        if lasting is None:
            self._count += len(times)
        else:
            self._lasting.take(lasting, times)

    def total(self) -> float:
        return self._count or _positive(self._lasting.total())


class _Mean:
    def __init__(self, worst: _Worst) -> None:
        self._worst, self._sum, self._weight = worst, SumBySecond(), _Weight()

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        self._weight.take(times, lasting)
        self._sum.take(series if lasting is None else series * lasting, times)
        self._worst.take(series, times)

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(self._sum.total() / self._weight.total(), self._worst.at_s)


class _RootMeanSquare:
    def __init__(self, worst: _Worst) -> None:
        self._worst, self._sum, self._weight = worst, SumBySecond(), _Weight()

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        self._weight.take(times, lasting)
        squares = series**2
        self._sum.take(squares if lasting is None else squares * lasting, times)
        self._worst.take(np.abs(series), times)

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(float(np.sqrt(self._sum.total() / self._weight.total())), self._worst.at_s)


class _StandardDeviation:
    """Square root of the mean squared deviation from the mean.

    When the number was that is farthest from the mean is known at the end only: the largest and the smallest are kept.
    """

    def __init__(self, worst: _Worst) -> None:
        self._worst, self._spread, self._mean = worst, SpreadBySecond(), _Mean(_Worst(True))
        self._largest, self._smallest = Largest(), Largest()

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        self._mean.take(series, times, lasting)
        self._spread.take(series, times, np.ones(len(series)) if lasting is None else lasting)
        self._largest.take(series, times)
        self._smallest.take(-series, times)

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        mean = self._mean.found(start_s, end_s).value
        above, below = self._largest.value - mean, mean + self._smallest.value
        farthest = self._largest if above >= below else self._smallest
        return MeasuredValue(float(np.sqrt(self._spread.variance())), farthest.at_s)


class _Percentile:
    """The smallest number that the series does not exceed for so much of the time.

    It keeps every number of the window, 8 bytes each, and as much again how long it lasts where it is held: an exact
    percentile cannot be had for less in one pass.
    """

    def __init__(self, worst: _Worst, percent: float) -> None:
        self._worst, self._percent = worst, percent
        self._series: list[Array] = []
        self._lasting: list[Array] = []

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        self._series.append(series.copy())
        if lasting is not None:
            self._lasting.append(lasting.copy())
        self._worst.take(series, times)

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        series = np.concatenate(self._series)
        if not self._lasting:
            rank = max(int(np.ceil(self._percent / 100.0 * len(series) * (1.0 - 1e-14))), 1)
            return MeasuredValue(float(np.partition(series, rank - 1)[rank - 1]), self._worst.at_s)
        order = np.argsort(series, kind="stable")
        until = np.cumsum(np.concatenate(self._lasting)[order])
        share = self._percent / 100.0 * _positive(float(until[-1])) * (1.0 - 1e-14)
        return MeasuredValue(
            float(series[order[min(int(np.searchsorted(until, share)), len(order) - 1)]]), self._worst.at_s
        )


class _Share:
    def __init__(self, worst: _Worst, inside: Callable[[Array], Marks], badness: Callable[[Array], Array]) -> None:
        self._worst, self._inside, self._badness = worst, inside, badness
        self._counted, self._weight = SumBySecond(), _Weight()

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        inside = self._inside(series).astype(float)
        self._weight.take(times, lasting)
        self._counted.take(inside if lasting is None else inside * lasting, times)
        self._worst.take(self._badness(series), times)

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(self._counted.total() / self._weight.total(), self._worst.at_s)


class _Count:
    """How often what is seen of the series differs from what was seen before."""

    def __init__(self, at_most: bool, seen: Callable[[Array], Array | Marks]) -> None:
        self._seen, self._at_most = seen, at_most
        self._before: Array | Marks | None = None
        self._count, self._last_s = 0, np.nan

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        if not len(series):
            return
        seen = self._seen(series)
        whole = seen if self._before is None else np.concatenate([self._before, seen])
        other = whole[1:] != whole[:-1]
        changed = times[-len(other) :][other.any(axis=1) if other.ndim == 2 else other] if len(other) else times[:0]
        self._count += len(changed)
        self._last_s = float(changed[-1]) if len(changed) else self._last_s
        self._before = seen[-1:].copy()

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(float(self._count), self._last_s if self._at_most and self._count else end_s)


class _Settling:
    """From when on, after the start of the window, all numbers are in a band.

    Of a series that ends outside it is known only that it takes longer than the window does.
    """

    def __init__(self, low: float, high: float, at_most: bool, limit: float | None) -> None:
        self._low, self._high, self._at_most, self._limit = low, high, at_most, limit
        self._since: float | None = None
        self._was_out = False

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        if not len(series):
            return
        outside = np.flatnonzero(~((series >= self._low) & (series <= self._high)))
        later = times[outside[-1] + 1 :] if len(outside) else times
        if len(outside) or self._since is None:
            self._since = float(later[0]) if len(later) else None
        self._was_out |= len(outside) > 0

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        if self._since is not None:
            return MeasuredValue(self._since - start_s, self._since) if self._was_out else MeasuredValue(0.0, start_s)
        longer = end_s - start_s
        if self._limit is not None and (longer > self._limit if self._at_most else longer >= self._limit):
            return MeasuredValue(longer, end_s)
        raise NotJudgedError(f"it has not settled when the window ends, {longer:g} s after its start")


class _Integral:
    """Over time: samples by the trapezoidal rule, what is held by the time it lasts."""

    def __init__(self, worst: _Worst) -> None:
        self._worst, self._sum = worst, SumBySecond()
        self._last: tuple[float, float] | None = None

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        if not len(series):
            return
        self._worst.take(series, times)
        if lasting is not None:
            self._sum.take(series * lasting, times)
            return
        if self._last is not None:
            times, series = np.append(self._last[0], times), np.append(self._last[1], series)
        self._last = float(times[-1]), float(series[-1])
        self._sum.take((series[1:] + series[:-1]) / 2.0 * np.diff(times), times[1:])

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(self._sum.total(), self._worst.at_s)


class _Increase:
    """The last number less the first."""

    def __init__(self) -> None:
        self._first: float | None = None
        self._last = np.nan

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        if len(series):
            self._first = float(series[0]) if self._first is None else self._first
            self._last = float(series[-1])

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(self._last - (np.nan if self._first is None else self._first), end_s)


class _Final:
    def __init__(self) -> None:
        self._last = np.nan

    def take(self, series: Array, times: Array, lasting: Array | None) -> None:
        if len(series):
            self._last = float(series[-1])

    def found(self, start_s: float, end_s: float) -> MeasuredValue:
        return MeasuredValue(self._last, end_s)


def _positive(lasting_s: float) -> float:
    if not lasting_s > 0:
        raise NotJudgedError("nothing in the window lasts")
    return lasting_s
