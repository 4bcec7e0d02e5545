"""What every check has in common: it takes blocks of a run one after another, and then it is judged."""

from __future__ import annotations

from collections.abc import Collection
from typing import Protocol

import numpy as np

from cube_sim.checks.reasons import NotJudgedError
from cube_sim.checks.samples import Array, Signals
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.verdict import CheckResult


class Judge(Protocol):
    """Judges one check.

    Attributes:
        needs: names of the signals it looks at.
    """

    needs: tuple[str, ...]

    def take(self, block: Signals) -> None:
        """Take in the rows of the next time: of each signal it needs, if it is recorded, all in the same span."""
        ...

    def result(self, recorded: Collection[str], duration_s: float | None) -> CheckResult:
        """Judge.

        Args:
            recorded: the names of all signals.
            duration_s: how long the run should have been; None if nothing is known of that.

        Raises:
            NotJudgedError: it cannot be judged.
        """
        ...


class Largest:
    """The largest of many values, the first one of equals, and its time.

    Attributes:
        value: -inf before the first.
        at_s: its time [s].
    """

    def __init__(self) -> None:
        self.value, self.at_s = -np.inf, np.nan

    def take(self, values: Array, times: Array) -> int | None:
        """Take in more values (n,) at their times (n,) [s]; which of them is the largest now, None for none."""
        if not len(values):
            return None
        index = int(np.argmax(values))
        if not (values[index] > self.value or np.isnan(self.at_s)):
            return None
        self.value, self.at_s = float(values[index]), float(times[index])
        return index


def judged(check: AnyCheck, value: float, at_s: float, detail: str) -> CheckResult:
    """Compare a value with the check's limit."""
    if not np.isfinite(value):
        raise NotJudgedError(f"the value is not finite ({detail})")
    relation, limit = check.bound
    at_least = relation == ">="
    value, at_s = float(value), float(at_s)
    margin = value - limit if at_least else limit - value
    # Spelled so that anything that does not compare fails.
    failed = not (value >= limit) if at_least else not (value <= limit)
    return CheckResult(check.title, "FAIL" if failed else "PASS", value, relation, limit, margin, at_s, detail)
