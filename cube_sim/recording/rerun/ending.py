"""How a run ended, in words for its view: verdict, reason, checks."""

from __future__ import annotations

from collections.abc import Iterator

from cube_sim.recording.run_end import RunEnd
from cube_sim.verdict import CheckResult

_SIGNS = {"<=": "≤", ">=": "≥"}
_HEAD = "| | check | value | margin | worst at |\n| --- | --- | --- | ---: | ---: |"


def ending_text(end: RunEnd) -> str:
    """Markdown: the verdict as a heading, how the run ended, a row for each check, why one did not pass."""
    said = [f"# {end.verdict or 'NOT JUDGED'}", _how(end)]
    if end.given_up:
        said.append(_plain(f"the path was given up: {end.given_up}"))
    if end.missing_s:
        spans = ", ".join(f"{start:g} s to {stop:g} s" for start, stop in end.missing_s)
        said.append(f"not recorded: {spans}; curves are broken there")
    if end.checks:
        said.append("\n".join([_HEAD, *_rows(end.checks)]))
    said += [_plain(f"{each.verdict} {each.name}: {each.detail}") for each in end.checks if each.verdict != "PASS"]
    return "\n\n".join(said)


def _how(end: RunEnd) -> str:
    when = "" if end.simulated_s is None or end.how == "recovered" else f", {end.simulated_s:g} s simulated"
    return _plain(f"{end.how}{when}{f': {end.reason}' if end.reason else ''}")


def _rows(checks: tuple[CheckResult, ...]) -> Iterator[str]:
    for check in checks:
        unit = "" if check.unit in ("", "1") else f" {check.unit}"
        value, limit, margin = (
            "–" if number is None else f"{number:.4g}" for number in (check.value, check.limit, check.margin)
        )
        asked = f"{value} {'must be ' if check.verdict == 'FAIL' else ''}{_SIGNS[check.relation]} {limit}{unit}"
        at = "–" if check.at_s is None else f"{check.at_s:.2f} s"
        yield f"| {' | '.join((f'**{check.verdict}**', _plain(check.name), asked, margin, at))} |"


def _plain(text: str) -> str:
    """Text whose signs mean nothing in Markdown."""
    return "".join(f"\\{each}" if each in "\\|*_`<>#[]" else each for each in text.replace("\n", " "))
