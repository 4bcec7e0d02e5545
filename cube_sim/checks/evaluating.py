"""Judging checks by recorded signals, whole ones or block by block."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Protocol, assert_never, runtime_checkable

from cube_sim.checks.allowed_forces import ForcesWithinLimits
from cube_sim.checks.baseline_difference import SignalOfBoth, StatisticOfBoth
from cube_sim.checks.beforehand import Beforehand
from cube_sim.checks.condition import ConditionHolds
from cube_sim.checks.exact_wrench import ExactWrench
from cube_sim.checks.false_alarms import FalseAlarms
from cube_sim.checks.judging import Judge
from cube_sim.checks.path_end import PathEnd
from cube_sim.checks.progress import Progress
from cube_sim.checks.quotient import ChangeAtEvent, RatioOfStatistics
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.checks.samples import Signals
from cube_sim.checks.signal_statistic import SignalStatistic
from cube_sim.checks.units import Units, unit_of
from cube_sim.scenario.check_blocks import (
    AllowedForcesCheckBlock,
    AlwaysCheckBlock,
    AnyCheck,
    BaselineCheckBlock,
    BeforeAfterCheckBlock,
    EventuallyCheckBlock,
    ExactWrenchCheckBlock,
    FalseAlarmsCheckBlock,
    PathEndCheckBlock,
    ProgressCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
)
from cube_sim.verdict import CheckResult

NOTHING_KNOWN = Beforehand()


@runtime_checkable
class SignalsInBlocks(Protocol):
    """Signals too long to be looked at as a whole."""

    def blocks(self, names: Collection[str]) -> Iterator[Signals]:
        """Rows of the signals of these names that are recorded, span of time after span of time."""
        ...


def evaluate(
    checks: Sequence[AnyCheck],
    signals: Signals,
    *,
    duration_s: float | None = None,
    units: Units = MappingProxyType({}),
    beforehand: Beforehand = NOTHING_KNOWN,
) -> tuple[CheckResult, ...]:
    """Judge every check.

    Args:
        checks: the scenario's checks.
        signals: ``channel.field`` -> array (n, 1 + width), column 0 time [s], increasing. `SignalsInBlocks` are looked
            at block by block, with the same results to the bit.
        duration_s: how long the run should have been; a recording that ends earlier is judged by no check.
        units: ``channel.field`` -> the unit of each of its numbers, for the results' own.
        beforehand: what else is known of the run.

    Returns:
        One result per check, in order.
    """
    evaluation = Evaluation(checks, beforehand)
    names = {name for name in evaluation.needs if name in signals}
    blocks = signals.blocks(names) if isinstance(signals, SignalsInBlocks) else [{n: signals[n] for n in names}]
    for block in blocks:
        evaluation.take(block)
    return evaluation.results(list(signals), duration_s=duration_s, units=units)


class Evaluation:
    """Checks that are judged by one block of signals after another.

    Args:
        checks: the scenario's.
        beforehand: what is known of the run before its rows come.

    Attributes:
        needs: names of the signals they look at.
    """

    def __init__(self, checks: Sequence[AnyCheck], beforehand: Beforehand = NOTHING_KNOWN) -> None:
        self._checks = tuple(checks)
        self._judges = [_judge(check, beforehand) for check in checks]
        self.needs = frozenset(name for judge in self._judges for name in judge.needs)

    def take(self, block: Signals) -> None:
        """Take in the rows of the next time: of each signal needed, if it is recorded."""
        for judge in self._judges:
            judge.take(block)

    def results(
        self,
        recorded: Collection[str],
        *,
        duration_s: float | None = None,
        units: Units = MappingProxyType({}),
    ) -> tuple[CheckResult, ...]:
        """One result per check, in order.

        Args:
            recorded: the names of all signals.
            duration_s: as for `evaluate`, like the next.
            units: of the signals.
        """
        return tuple(
            replace(_result(check, judge, recorded, duration_s), unit=unit_of(check, units))
            for check, judge in zip(self._checks, self._judges, strict=True)
        )


def _judge(check: AnyCheck, beforehand: Beforehand) -> Judge:
    match check:
        case SignalCheckBlock():
            return SignalStatistic(check, beforehand)
        case AlwaysCheckBlock() | EventuallyCheckBlock():
            return ConditionHolds(check, beforehand)
        case BaselineCheckBlock():
            asked = check.asked
            return SignalOfBoth(check, beforehand) if asked is None else StatisticOfBoth(check, asked, beforehand)
        case RatioCheckBlock():
            return RatioOfStatistics(check, beforehand)
        case BeforeAfterCheckBlock():
            return ChangeAtEvent(check, beforehand)
        case AllowedForcesCheckBlock():
            return ForcesWithinLimits(check)
        case ExactWrenchCheckBlock():
            return ExactWrench(check)
        case PathEndCheckBlock():
            return PathEnd(check)
        case ProgressCheckBlock():
            return Progress(check, beforehand)
        case FalseAlarmsCheckBlock():
            return FalseAlarms(check, beforehand)
        case _:
            assert_never(check)


def _result(check: AnyCheck, judge: Judge, recorded: Collection[str], duration_s: float | None) -> CheckResult:
    try:
        return judge.result(recorded, duration_s)
    except NotJudgedError as reason:
        relation, limit = check.bound
        return CheckResult(check.title, "ERROR", None, relation, limit, None, None, str(reason))
