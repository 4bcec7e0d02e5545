"""The page of a sweep: pass rate, what the checks came to, what matters, which samples are worst, where they fail."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa

from cube_sim.campaign.counting import counted_by_note
from cube_sim.campaign.folder import recording_of
from cube_sim.campaign.influence import Correlation, Parameter, drawn_columns_of, parameters_of, rank_correlation
from cube_sim.campaign.result import SweepResult
from cube_sim.campaign.sample_flight import CHECK
from cube_sim.campaign.summary import check_names, check_summaries, limits_of, numbers, relative_margins
from cube_sim.flight_statistics import STATISTICS
from cube_sim.report.failure_map import Axis, failure_map, lost_map
from cube_sim.report.histogram import Spread, histogram
from cube_sim.report.html_table import badge, table
from cube_sim.report.markup import element, number, text
from cube_sim.report.style import CSS
from cube_sim.scenario.samples_block import LOST_THRUSTERS

WORST, PARAMETERS, CHECKS, NOTE_VALUES = 20, 20, 8, 200
"""So many samples, parameters, checks and values of a note are in a table."""
CHANCE = 0.01
"""A correlation that chance alone gives more often than this is faint."""
_MORE_CSS = "code{font:12px ui-monospace,Menlo,Consolas,monospace;overflow-wrap:anywhere}.faint{color:#8c959f}"
_MORE_CSS += ".lost{max-width:620px}\n"


def sweep_report(sweep: SweepResult) -> str:
    """The page.

    Args:
        sweep: flown, or read back.

    Returns:
        HTML that is well-formed XML, with all it needs inside; of the same rows the same text.
    """
    sections = [(name, title, content) for name, title, content in _sections(sweep) if content]
    links = "".join(f'<a href="#{name}">{text(title)}</a>' for name, title, _ in sections)
    body = [
        *_head(sweep),
        element("nav", links),
        *(f'<section id="{name}"><h2>{text(title)}</h2>{content}</section>' for name, title, content in sections),
        "<footer><p>Made by cube-sim report from the rows of cube-sim sweep.</p></footer>",
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"/>'
        '<meta name="viewport" content="width=device-width, initial-scale=1"/>'
        f"<title>{text(sweep.name)}: {sweep.rows.num_rows} samples</title><style>{CSS}{_MORE_CSS}</style></head>\n"
        "<body>" + "\n".join(body) + "</body></html>\n"
    )


def _head(sweep: SweepResult) -> Iterator[str]:
    verdict = sweep.verdict
    shown = "" if verdict is None else badge(verdict.verdict)
    yield f"<h1>{text(sweep.name)}: {sweep.rows.num_rows} samples {shown}</h1>"
    if verdict is not None:
        yield f"<p>{text(verdict.detail)}</p>"
    missing = sweep.head["count"] - sweep.rows.num_rows
    if missing > 0:
        yield f'<p class="remark">{missing} of {sweep.head["count"]} samples are not flown</p>'
    known = sweep.head["identity"]["versions"]
    facts = [sweep.head["scenario"], f"cube-sim {known.get('cube-sim', 'of unknown version')}"]
    facts += [f"{path} = {value}" for path, value in sweep.head["settings"].items()]
    yield f'<p class="fact">{text(" · ".join(facts))}</p>'


def _sections(sweep: SweepResult) -> Iterator[tuple[str, str, str]]:
    rows = sweep.rows
    if not rows.num_rows:
        return
    margins = relative_margins(rows, sweep.limits)
    parameters = parameters_of(rows, sweep.head["thrusters"])
    yield "rate", "Pass rate", _rate(sweep)
    yield "checks", "Checks", _checks(sweep)
    yield "values", "How their values are spread", _spreads(sweep)
    yield "influence", "What matters", _influence(sweep, parameters, margins)
    yield "notes", "What was noted", _notes(sweep)
    yield "worst", "Worst samples", _worst(sweep)
    yield "map", "Where it fails", _maps(sweep, parameters, margins)
    yield "statistics", "All samples", _statistics(rows)


def _rate(sweep: SweepResult) -> str:
    low, high, confidence = sweep.interval
    came = sweep.counted
    cells = [
        f"<b>{100.0 * came.passed / came.count:.2f} %</b>" if came.count else "–",
        f"{100.0 * low:.2f} % to {100.0 * high:.2f} %",
        *(str(count) for count in (came.passed, came.failed, came.errors)),
        _required(sweep),
    ]
    header = ("pass rate", f"{100.0 * confidence:g} % interval", "pass", "fail", "not judged", "required")
    note = "The interval is that of Clopper and Pearson; a sample that could not be judged has not passed."
    if came.words != "samples pass":
        note += f" Counted is how many {came.words}."
    return table(header, [cells], "rrrrrs", narrow=True) + f'<p class="dim">{text(note)}</p>'


def _required(sweep: SweepResult) -> str:
    required = sweep.required
    if required is None or required.pass_rate is None:
        return "every one"
    return f"{100.0 * required.pass_rate:g} % at {100.0 * required.confidence:g} %"


def _checks(sweep: SweepResult) -> str:
    relations = {check["name"]: check["relation"] for check in sweep.head["checks"]}
    rows = [
        (
            text(check.name),
            text(_limit(sweep, check.name, relations.get(check.name, ""))),
            str(check.passed),
            f'<span class="hot">{check.failed}</span>' if check.failed else "0",
            str(check.errors),
            number(check.least_margin),
            "–" if check.worst is None else str(check.worst),
        )
        for check in check_summaries(sweep.rows)
    ]
    header = ("check", "limit", "pass", "fail", "not judged", "smallest margin", "of sample")
    return table(header, rows, "wrrrrrr")


def _limit(sweep: SweepResult, name: str, relation: str) -> str:
    """The limit of a check in words; of one that is drawn, from where to where."""
    limits = limits_of(sweep.rows, name, sweep.limits)
    limits = limits[np.isfinite(limits)]
    if not len(limits):
        return "–"
    low, high = float(limits.min()), float(limits.max())
    return f"{relation} {number(low)}".strip() if low == high else f"{relation} {number(low)} to {number(high)}".strip()


def _spreads(sweep: SweepResult) -> str:
    known = {check["name"]: check for check in sweep.head["checks"]}
    drawn = []
    for name in check_names(sweep.rows):
        column = f"{CHECK}.{name}"
        values, check = numbers(sweep.rows, f"{column}.value"), known.get(name, {})
        passed = np.array([verdict == "PASS" for verdict in sweep.rows[f"{column}.verdict"].to_pylist()])
        limits = np.unique(limits_of(sweep.rows, name, sweep.limits))
        limit = float(limits[0]) if len(limits) == 1 and np.isfinite(limits[0]) else None
        spread = Spread(name, _unit(sweep.rows, name), values, passed, check.get("relation", ""), limit)
        drawn.append(f"<div>{histogram(spread)}</div>")
    return f'<div class="two">{"".join(drawn)}</div>' if drawn else ""


def _unit(rows: pa.Table, name: str) -> str:
    """Of a check's values; "" where nothing was judged."""
    column = f"{CHECK}.{name}.unit"
    return next((unit for unit in rows[column].to_pylist() if unit), "") if column in rows.column_names else ""


def _named(sweep: SweepResult, name: str) -> str:
    """What was varied, and what its numbers are where they are not its values."""
    gives = sweep.head["varied"].get(name, {}).get("gives", "value")
    return name if gives == "value" else f"{name} ({gives})"


def _influence(sweep: SweepResult, parameters: list[Parameter], margins: np.ndarray) -> str:
    rows = sweep.rows
    if not parameters or rows.num_rows < 5:
        return ""
    checks = check_names(rows)[:CHECKS]
    columns = [numbers(rows, f"{CHECK}.{name}.margin") for name in checks]
    found = [
        (each.name, [rank_correlation(each.values, column) for column in (margins, *columns)]) for each in parameters
    ]
    found.sort(key=lambda item: -np.nan_to_num(abs(item[1][0].rho), nan=-1.0))
    cells = [(text(_named(sweep, name)), *map(_rho, correlations)) for name, correlations in found[:PARAMETERS]]
    header = ("what was varied", "smallest margin", *checks)
    words = (
        "Rank correlation of what was varied with the margins, −1 to 1: below 0 more of it takes margin away. It sees "
        "what rises or falls throughout, and is near 0 also for what is worst, or best, in the middle. What chance "
        "alone gives more often than once in a hundred times is grey."
    )
    return table(header, cells, "w" + "r" * (1 + len(checks)), narrow=True) + f'<p class="dim">{text(words)}</p>'


def _rho(correlation: Correlation) -> str:
    if np.isnan(correlation.rho):
        return "–"
    said = f"{correlation.rho:+.2f}".replace("-", "−")
    return f'<span class="faint">{said}</span>' if correlation.p > CHANCE else f"<b>{said}</b>"


def _notes(sweep: SweepResult) -> str:
    """Of each note in words, what came of the samples with each of its values."""
    required = sweep.required
    forecast = None if required is None else required.foretelling
    should = () if forecast is None else ("should pass", "of these do")
    tables = []
    for name, counts in counted_by_note(sweep.rows, forecast, NOTE_VALUES).items():
        cells = []
        for each in counts:
            figures = [str(count) for count in each[1 : 5 + len(should)]]
            if each.kept != each.foretold:
                figures[-1] = f'<span class="hot">{figures[-1]}</span>'
            cells.append((text(each.value), *figures))
        header = (name, "samples", "pass", "fail", "not judged", *should)
        tables.append(table(header, cells, "w" + "r" * (len(header) - 1), narrow=True))
    return "".join(tables)


def _worst(sweep: SweepResult) -> str:
    rows = []
    for each in sweep.worst(WORST):
        kept = recording_of(sweep.folder, each.sample)
        record = f"<br/>recorded: <code>{text(kept)}</code>" if Path(kept).is_dir() else ""
        rows.append(
            (
                str(each.sample),
                badge(each.verdict),
                text(each.reason),
                f"<code>{text(sweep.command(each.sample))}</code>{record}",
            )
        )
    return table(("sample", "verdict", "why", "flown again by"), rows, "rswk")


def _maps(sweep: SweepResult, parameters: list[Parameter], margins: np.ndarray) -> str:
    rows = sweep.rows
    samples, verdicts, reasons = (rows[name].to_pylist() for name in ("sample", "verdict", "reason"))
    strength = {each.name: abs(np.nan_to_num(rank_correlation(each.values, margins).rho)) for each in parameters}
    ranked = sorted((each for each in parameters if each.is_number), key=lambda each: -strength[each.name])
    drawn = ""
    if len(ranked) > 1:
        one, other = (Axis(_named(sweep, each.name), each.values) for each in ranked[:2])
        drawn += failure_map(one, other, samples, verdicts, reasons)
    elif ranked:
        finite = np.where(np.isfinite(margins), margins, np.nan)
        margin = Axis("smallest margin, as a share of the limit", finite)
        drawn += failure_map(Axis(_named(sweep, ranked[0].name), ranked[0].values), margin, samples, verdicts, reasons)
    if LOST_THRUSTERS in rows.column_names:
        lost = [frozenset(filter(None, (gone or "").split("+"))) for gone in rows[LOST_THRUSTERS].to_pylist()]
        lost_of = lost_map(sweep.head["thrusters"], lost, [verdict == "PASS" for verdict in verdicts])
        drawn += f'<div class="lost">{lost_of}</div>'
    return drawn


def _statistics(rows: pa.Table) -> str:
    """What was varied, what the flights came to and what they took: the spread of each number."""
    cells = []
    for name in (*drawn_columns_of(rows), *STATISTICS, "flight_s", "wall_s"):
        if name not in rows.column_names:
            continue
        values = numbers(rows, name)
        values = values[np.isfinite(values)]
        if len(values):
            quantiles = np.quantile(values, (0.0, 0.05, 0.5, 0.95, 1.0)).tolist()
            cells.append((text(name), *map(number, quantiles), number(float(values.mean()))))
    return table(("", "least", "5 %", "median", "95 %", "most", "mean"), cells, "wrrrrrr", narrow=True)
