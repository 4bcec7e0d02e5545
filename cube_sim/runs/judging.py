"""A recorded run held against checks."""

from __future__ import annotations

from collections.abc import Sequence

from cube_sim.checks import evaluate
from cube_sim.runs.recorded_run import RecordedRun
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.verdict import CheckResult, Verdict, overall


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
    results = evaluate(scenario.checks if checks is None else checks, run.signals, duration_s=scenario.duration_s)
    remarks = [run.flaw] if run.flaw else []
    if run.end is None:
        ends = [line for line in run.log if line.level == "ERROR"]
        remarks += [f"ended early, at {line.t:g} s: {line.text}" for line in ends[-1:] if line.t < scenario.duration_s]
    elif run.end.how == "ended early":
        remarks.append(f"ended early, at {run.end.simulated_s:g} s: {run.end.reason}")
    return overall(results, complete=not remarks), results, tuple(remarks)
