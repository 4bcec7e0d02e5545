"""The result of a run as a table, for a terminal or for a test report."""

from __future__ import annotations

import io
from collections.abc import Sequence

from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from cube_sim.verdict import CheckResult

STYLES = {"PASS": "bold green", "FAIL": "bold red", "ERROR": "bold magenta"}
"""Of each verdict."""


def result_table(
    title: str, verdict: str, results: Sequence[CheckResult], remarks: Sequence[str] = ()
) -> RenderableType:
    """Verdict first, remarks on the whole run, a row per check, then why each check that did not pass did not."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("check")
    table.add_column("verdict", no_wrap=True)
    for heading in ("value", "limit", "margin"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("worst at", justify="right", no_wrap=True)
    for result in results:
        table.add_row(
            Text(result.name),
            Text(result.verdict, STYLES[result.verdict]),
            _number(result.value),
            f"{result.relation} {_number(result.limit)}",
            _number(result.margin),
            Text(result.unit),
            "-" if result.at_s is None else f"{result.at_s:.2f} s",
        )
    reasons = [
        Text(f"{result.verdict} {result.name}: {result.detail}") for result in results if result.verdict != "PASS"
    ]
    heading = Text.assemble((verdict, STYLES.get(verdict, "bold")), f"  {title}")
    return Group(heading, *map(Text, remarks), Text(), table, *([Text(), *reasons] if reasons else []))


def as_text(renderable: RenderableType, width: int = 110) -> str:
    """Plain text without colours, its lines at most `width` long."""
    stream = io.StringIO()
    Console(file=stream, width=width, color_system=None, force_terminal=False, legacy_windows=False).print(renderable)
    return "\n".join(line.rstrip() for line in stream.getvalue().splitlines())


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
