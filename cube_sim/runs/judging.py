"""A recorded run held against checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from cube_sim.checks import evaluate
from cube_sim.recording.channels import SUPPLY, units_of, why_absent
from cube_sim.recording.navigation_channels import READINGS, navigation_channels
from cube_sim.runs.recorded_run import RecordedRun, Span
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
    scenario = run.scenario
    asked = scenario.checks if checks is None else checks
    units = units_of(run.recording.channels)
    results = evaluate(asked, run.signals, duration_s=scenario.duration_s, units=units)
    results = tuple(_with_reason(*both, run) for both in zip(asked, results, strict=True))
    results = tuple(_as_far_as_seen(*both, run.missing_s) for both in zip(asked, results, strict=True))
    remarks = [run.flaw] if run.flaw else []
    if run.end is None:
        ends = [line for line in run.log if line.level == "ERROR"]
        remarks += [f"ended early, at {line.t:g} s: {line.text}" for line in ends[-1:] if line.t < scenario.duration_s]
    elif run.end.how == "ended early":
        remarks.append(f"ended early, at {run.end.simulated_s:g} s: {run.end.reason}")
    return overall(results, complete=not remarks), results, tuple(remarks)


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


def _as_far_as_seen(check: AnyCheck, result: CheckResult, missing_s: Sequence[Span]) -> CheckResult:
    """A check that passed by the rows that are left has not been shown to hold where rows of its window are missing."""
    if result.verdict != "PASS" or isinstance(check, PathEndCheckBlock):  # once at the end is at the end
        return result
    start, end = 0.0, inf
    if isinstance(check, SignalCheckBlock):
        end = inf if check.to_s is None else check.to_s
        start = end if check.statistic == "final" else check.from_s or 0.0
    unseen = [f"{a:g} s to {b:g} s" for a, b in missing_s if a <= end and b > start]
    if not unseen:
        return result
    return replace(result, verdict="ERROR", detail=f"{result.detail}; nothing is recorded from {', '.join(unseen)}")
