"""The check of one statistic of one signal."""

from __future__ import annotations

from collections.abc import Collection

from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.judged_window import JudgedWindow
from cube_sim.checks.judging import judged
from cube_sim.checks.measured import Measured
from cube_sim.checks.samples import Signals
from cube_sim.scenario.check_blocks import SignalCheckBlock
from cube_sim.scenario.windows import window_of
from cube_sim.verdict import CheckResult


class SignalStatistic:
    """Judges a `SignalCheckBlock`."""

    def __init__(self, check: SignalCheckBlock, beforehand: Beforehand) -> None:
        self._check = check
        relation, limit = check.bound
        window = JudgedWindow(window_of(check, beforehand.events), beforehand)
        self._measured = Measured(check, window, beforehand, relation == "<=", limit)
        self.needs = self._measured.needs

    def take(self, block: Signals) -> None:
        """See `Judge`."""
        self._measured.take(block)

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """See `Judge`."""
        value, at_s = self._measured.found(recorded, duration_s)
        return judged(self._check, value, at_s, self._measured.detail)
