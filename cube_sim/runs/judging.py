"""A recorded run held against checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from cube_sim.checks import Evaluation, evaluate
from cube_sim.judged_store import beforehand_of
from cube_sim.recording.channels import SUPPLY, units_of, why_absent
from cube_sim.recording.navigation_channels import READINGS, navigation_channels
from cube_sim.runs.recorded_run import RecordedRun
from cube_sim.runs.row_times import Span
from cube_sim.scenario.check_blocks import (
    AlwaysCheckBlock,
    AnyCheck,
    BaselineCheckBlock,
    BeforeAfterCheckBlock,
    EventuallyCheckBlock,
    PathEndCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
)
from cube_sim.scenario.check_windows import windows_of
from cube_sim.scenario.windows import WindowKeys
from cube_sim.verdict import CheckResult, Verdict, overall

_ANY_WIDTH = 1_000
GROWS = "max", "max_abs", "crossings", "changes", "settling"
"""Statistics that more rows can only make larger."""


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
    if run.vehicles:
        return _of_several(run, checks)
    asked = run.scenario.checks if checks is None else checks
    channels = run.recording.channels
    results = evaluate(
        asked,
        run.signals,
        duration_s=asked_duration_s(run),
        units=units_of(channels),
        beforehand=beforehand_of(run.scenario, channels, run.header.inputs),
    )
    return concluded(run, asked, results)


def _of_several(
    run: RecordedRun, checks: Sequence[AnyCheck] | None
) -> tuple[Verdict, tuple[CheckResult, ...], tuple[str, ...]]:
    """Judge each vehicle by its own checks, and all of them by those over several, or by others in place of both."""
    found: list[CheckResult] = []
    for name, one in run.vehicles.items() if checks is None else ():
        if one.scenario.checks:
            found += [replace(result, name=f"{name}: {result.name}") for result in judged(one)[1]]
    _, results, remarks = judged(run.together, checks)
    found += results
    shown = any(result.verdict == "FAIL" for result in found)
    stopped = run.end is not None and run.end.how == "stopped" and not run.flaw
    failed = stopped and run.end is not None and run.end.stop == "FAIL"
    return overall(found, complete=shown or stopped or not remarks, failed=failed), tuple(found), remarks


def asked_duration_s(run: RecordedRun) -> float | None:
    """How long a run has to be for its checks to be judged [s]; None where any part of it may show something."""
    # A flight that ended itself has shown nothing; of any other, what there is of it may show that a check fails.
    if run.end is not None and run.end.how == "stopped" and not run.flaw:
        return run.end.simulated_s
    return run.whole.duration_s if _ended_itself(run) else None


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
    scenario = run.whole
    results = tuple(_with_reason(*both, run) for both in zip(asked, results, strict=True))
    results = tuple(_as_far_as_seen(*both, run) for both in zip(asked, results, strict=True))
    remarks = [run.flaw] if run.flaw else []
    if run.end is None:
        ends = [line for line in run.log if line.level == "ERROR"]
        remarks += [f"ended early, at {line.t:g} s: {line.text}" for line in ends[-1:] if line.t < scenario.duration_s]
    elif run.end.how == "stopped":
        stopped = f"stopped, at {run.end.simulated_s:g} s: {run.end.reason}"
        failed = run.end.stop == "FAIL" and not run.flaw
        complete = not remarks
        return overall(results, complete=complete, failed=failed), results, (*remarks, stopped)
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
    for signal in (named.signal for named in check.named_signals):
        if signal not in run.fields and (why := why_absent(signal)):
            return replace(result, detail=f"{signal} is not recorded: {why}")
    return result


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
    beforehand = beforehand_of(run.scenario, run.recording.channels)
    channels = {name.partition(".")[0] for name in Evaluation([check], beforehand).needs}
    lost = {span for loss in run.losses if loss.channel in channels for span in loss.spans}
    spans = sorted({*run.missing_s, *lost})
    if run.end is not None and run.end.simulated_s is not None and run.end.simulated_s < run.scenario.duration_s:
        spans.append((run.end.simulated_s, run.scenario.duration_s))
    windows = [window.within(inf) for window in windows_of(check, run.scenario.events)]
    if isinstance(check, SignalCheckBlock) and check.statistic == "final" and check.phase is None:
        end = min(windows[0][1], run.scenario.duration_s)
        windows = [(end - 1.5 * run.scenario.control_period_s, end)]
    return [(a, b) for a, b in spans if any(a <= end and b > start for start, end in windows)]


def _shown_by_some(check: AnyCheck, result: CheckResult, unseen: Sequence[Span]) -> Verdict | None:
    """Which verdict the rows of a part of the time show, whatever the others are; None where they show none."""
    if isinstance(check, PathEndCheckBlock):  # once at the end is at the end
        return "PASS"
    if isinstance(check, WindowKeys) and check.phase is not None:  # what is lost may have opened or closed the window
        return None
    match check:
        case AlwaysCheckBlock():
            return "FAIL"
        case BaselineCheckBlock():
            return "FAIL" if check.asked is None else None
        case EventuallyCheckBlock():
            return "PASS"
        case RatioCheckBlock() | BeforeAfterCheckBlock():
            return None
        case SignalCheckBlock():
            grows = check.statistic in GROWS
            if not grows and check.statistic not in ("min", "min_abs"):
                return None
            return "FAIL" if grows == (check.at_most is not None) else "PASS"
    # Behind a gap the thrusters' limits may be others, told in the rows that are lost.
    return "FAIL" if result.at_s is not None and result.at_s < unseen[0][0] else None
