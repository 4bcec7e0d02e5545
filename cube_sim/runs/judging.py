"""A recorded run held against checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from cube_sim.checks import Evaluation, evaluate
from cube_sim.recording.channels import SUPPLY, units_of, why_absent
from cube_sim.recording.navigation_channels import READINGS, navigation_channels
from cube_sim.runs.recorded_run import RecordedRun
from cube_sim.runs.row_times import Span
from cube_sim.scenario.check_blocks import AnyCheck, PathEndCheckBlock, SignalCheckBlock
from cube_sim.verdict import CheckResult, Verdict, overall

_ANY_WIDTH = 1_000


def judged(
    run: RecordedRun, checks: Sequence[AnyCheck] | None = None
) -> tuple[Verdict, tuple[CheckResult, ...], tuple[str, ...]]:
    """Judge a run again.

    Args:
        run: the run.
        checks: in place of those of its scenario.

    Returns:
        The verdict, one result per check, and why the whole cannot be judged, a line each.
    """
    asked = run.scenario.checks if checks is None else checks
    units = units_of(run.recording.channels)
    return concluded(run, asked, evaluate(asked, run.signals, duration_s=asked_duration_s(run), units=units))


def asked_duration_s(run: RecordedRun) -> float | None:
    """How long a run has to be for its checks to be judged [s]; None where any part of it may show something."""
    # A flight that ended itself has shown nothing; of any other, what there is of it may show that a check fails.
    return run.scenario.duration_s if _ended_itself(run) else None


def concluded(
    run: RecordedRun, asked: Sequence[AnyCheck], results: Sequence[CheckResult]
) -> tuple[Verdict, tuple[CheckResult, ...], tuple[str, ...]]:
    """What the results of the rows that are there say of the whole run.

    Args:
        run: the run.
        asked: the checks.
        results: one of each.

    Returns:
        As `judged`.
    """
    scenario = run.scenario
    results = tuple(_with_reason(*both, run) for both in zip(asked, results, strict=True))
    results = tuple(_as_far_as_seen(*both, run) for both in zip(asked, results, strict=True))
    remarks = [run.flaw] if run.flaw else []
    if run.end is None:
        ends = [line for line in run.log if line.level == "ERROR"]
        remarks += [f"ended early, at {line.t:g} s: {line.text}" for line in ends[-1:] if line.t < scenario.duration_s]
    elif run.end.how == "ended early":
        remarks.append(f"ended early, at {run.end.simulated_s:g} s: {run.end.reason}")
    shown = any(result.verdict == "FAIL" for result in results)
    return overall(results, complete=shown or not remarks), results, tuple(remarks)


def _ended_itself(run: RecordedRun) -> bool:
    if not run.flaw or run.end is not None:
        return not run.flaw
    return any(line.level == "ERROR" and line.t >= run.recorded_s for line in run.log)


def nameable(run: RecordedRun) -> dict[str, int]:
    """How many numbers a sample has, of each signal that a check may name: of those too that this run did not model.

    A check on one of the latter cannot be judged; that is no mistake in the check.
    """
    supply = (f"power.{name}" for name in SUPPLY)
    sensed = (
        f"{channel.name}.{field.name}"
        for channel in navigation_channels(dict.fromkeys(READINGS, 1.0))
        for field in channel.fields
    )
    known = {name: field.width for name, field in run.fields.items()}
    return {**dict.fromkeys((*supply, *sensed), _ANY_WIDTH), **known}


def _with_reason(check: AnyCheck, result: CheckResult, run: RecordedRun) -> CheckResult:
    """Of a signal that this run did not record: why not."""
    if check.named_signal is None or check.named_signal[0] in run.fields:
        return result
    why = why_absent(check.named_signal[0])
    return replace(result, detail=f"{check.named_signal[0]} is not recorded: {why}") if why else result


def _as_far_as_seen(check: AnyCheck, result: CheckResult, run: RecordedRun) -> CheckResult:
    """What a check shows of a run that may lack rows of its window: what they might change is not shown."""
    if result.verdict == "ERROR" or run.complete:
        return result
    if run.altered:
        return replace(result, verdict="ERROR", detail=f"{result.detail}; {run.flaw}")
    unseen = _unseen(check, run)
    if not unseen or result.verdict == _shown_by_some(check, result, unseen):
        return result
    spans = ", ".join(f"{a:g} s to {b:g} s" for a, b in unseen)
    return replace(result, verdict="ERROR", detail=f"{result.detail}; nothing is recorded from {spans}")


def _unseen(check: AnyCheck, run: RecordedRun) -> list[Span]:
    """From when to when rows are missing that a check asks for [s]."""
    channels = {name.partition(".")[0] for name in Evaluation([check]).needs}
    lost = {span for loss in run.losses if loss.channel in channels for span in loss.spans}
    spans = sorted({*run.missing_s, *lost})
    if run.end is not None and run.end.simulated_s is not None and run.end.simulated_s < run.scenario.duration_s:
        spans.append((run.end.simulated_s, run.scenario.duration_s))
    start, end = 0.0, inf
    if isinstance(check, SignalCheckBlock):
        end = inf if check.to_s is None else check.to_s
        start = check.from_s or 0.0
        if check.statistic == "final":
            start = min(end, run.scenario.duration_s) - 1.5 * run.scenario.control_period_s
    return [(a, b) for a, b in spans if a <= end and b > start]


def _shown_by_some(check: AnyCheck, result: CheckResult, unseen: Sequence[Span]) -> Verdict | None:
    """Which verdict the rows of a part of the time show, whatever the others are; None where they show none."""
    if isinstance(check, PathEndCheckBlock):  # once at the end is at the end
        return "PASS"
    if isinstance(check, SignalCheckBlock):
        largest = check.statistic in ("max", "max_abs")
        if not largest and check.statistic != "min":
            return None
        return "FAIL" if largest == (check.at_most is not None) else "PASS"
    # Behind a gap the thrusters' limits may be others, told in the rows that are lost.
    return "FAIL" if result.at_s is not None and result.at_s < unseen[0][0] else None
