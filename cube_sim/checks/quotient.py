"""Checks of two statistics: one over another, and one after an event against the same before it."""

from __future__ import annotations

from collections.abc import Collection

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.judging import judged
from cube_sim.checks.measured import Measured
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.checks.samples import Signals
from cube_sim.scenario.check_blocks import BeforeAfterCheckBlock, RatioCheckBlock
from cube_sim.scenario.check_windows import before_and_after
from cube_sim.scenario.windows import window_of
from cube_sim.verdict import CheckResult


class RatioOfStatistics:
    """Judges a `RatioCheckBlock`."""

    def __init__(self, check: RatioCheckBlock, beforehand: Beforehand) -> None:
        self._check, events = check, beforehand.events
        at_most = check.bound.relation == "<="
        above, below = check.numerator, check.denominator
        windows = [JudgedWindow(window_of(each, events), beforehand) for each in (above, below)]
        self._above = Measured(above, windows[0], beforehand, at_most)
        self._below = Measured(below, windows[1], beforehand, not at_most)
        self.needs = tuple(dict.fromkeys((*self._above.needs, *self._below.needs)))

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._above.take(block)
        self._below.take(block)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        above, below = self._above.found(recorded, duration_s), self._below.found(recorded, duration_s)
        least = self._check.least_denominator
        divisor = below.value if least is None or abs(below.value) >= least else least
        counted = "" if divisor == below.value else f", counted as {divisor:g}"
        detail = f"{above.value:g} over {below.value:g}{counted}: {self._above.detail}; {self._below.detail}"
        return judged(self._check, over(above.value, divisor), above.at_s, detail)


class ChangeAtEvent:
    """Judges a `BeforeAfterCheckBlock`."""

    def __init__(self, check: BeforeAfterCheckBlock, beforehand: Beforehand) -> None:
        self._check = check
        before, after = (JudgedWindow(each, beforehand) for each in before_and_after(check, beforehand.events))
        at_most = check.bound.relation == "<="
        self._before = Measured(check, before, beforehand, not at_most)
        self._after = Measured(check, after, beforehand, at_most)
        self.needs = self._after.needs

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._before.take(block)
        self._after.take(block)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        before, after = self._before.found(recorded, duration_s), self._after.found(recorded, duration_s)
        differs = self._check.compare == "difference"
        value = after.value - before.value if differs else over(after.value, before.value)
        detail = f"{before.value:g} before, {after.value:g} after: {self._before.detail}; {self._after.detail}"
        return judged(self._check, value, after.at_s, detail)


def over(numerator: float, denominator: float) -> float:
    """A quotient.

    Raises:
        NotJudgedError: of nothing.
    """
    if denominator == 0:
        raise NotJudgedError(f"{numerator:g} over 0 is no number")
    return numerator / denominator
