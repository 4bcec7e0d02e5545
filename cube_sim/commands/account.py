"""What a run says of itself, in lines for a terminal, a test report or a JUnit file: how long it lasted, its log."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cube_sim.run_log import LogLine, gathered

if TYPE_CHECKING:
    from cube_sim.simulation import Run
    from cube_sim.verdict import CheckResult

MOST_LINES = 20
"""So many different sentences are shown; the recording holds all of them."""


def lasted(result: Run, duration_s: float) -> str:
    """How much of the time asked for was simulated, e.g. ``120 s simulated`` or ``3.4 of 120 s simulated``."""
    if result.ended_early is None:
        return f"{result.simulated_s:g} s simulated"
    return f"{result.simulated_s:g} of {duration_s:g} s simulated"


def early_end(result: Run) -> list[str]:
    """When and why the run ended before its time, as one line; none if it did not."""
    end = result.ended_early
    if end is None:
        return []
    how = "ended early" if end.verdict == "ERROR" else "stopped"
    failed = ", which is a failure" if end.verdict == "FAIL" else ""
    return [f"{how}, at {end.time_s:g} s: {end.reason}{failed}"]


def judged_line(result: CheckResult) -> str:
    """Verdict, limit, margin, time and what was looked at, of a check whose value is told beside."""
    unit = "" if result.unit in ("", "1") else f" {result.unit}"
    if result.margin is None or result.at_s is None:
        return f"{result.verdict}: must be {result.relation} {result.limit:g}{unit}; {result.detail}"
    asked = f"{result.relation} {result.limit:g}{unit}, margin {result.margin:g}{unit} at {result.at_s:g} s"
    return f"{result.verdict}: {asked}; {result.detail}"


def log_lines(log: tuple[LogLine, ...], most: int = MOST_LINES) -> list[str]:
    """A line for each sentence of a log, those alike gathered; what is too much is left out, errors never.

    Args:
        log: in the order of time.
        most: number of lines of no errors.
    """
    entries = gathered(log)
    others = [entry for entry in entries if entry.first.level == "WARNING"]
    left_out = others[most:]
    lines = [str(entry) for entry in entries if entry not in left_out]
    return [*lines, f"... and {len(left_out)} more, in the recording's log"] if left_out else lines


def section(heading: str, lines: list[str]) -> list[str]:
    """Lines set off under a heading; nothing at all where there are none."""
    return ["", heading, *(f"  {line}" for line in lines)] if lines else []
