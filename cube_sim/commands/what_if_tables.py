"""What a model can do as it is, beside what it could do with other values."""

from __future__ import annotations

import numpy as np
from rich.table import Table

from cube_sim.commands.analysis_report import Report
from cube_sim.commands.output import console_for_tables


def print_beside(before: Report, after: Report, settings: list[str]) -> None:
    """Print both, what differs marked, and the remarks that only one has, above the analysis of the second."""
    console = console_for_tables()
    console.print(f"{before.title} as it is, and with {', '.join(settings)}", markup=False, highlight=False)
    table = Table(box=None, pad_edge=False, header_style="dim")
    for header in ("", "as it is", "then", ""):
        table.add_column(header, justify="left" if not header else "right")
    for (name, old), (_, new) in zip(_rows(before), _rows(after), strict=True):
        table.add_row(name, old, new, "" if old == new else "*")
    console.print(table)
    for name, report in (("as it is", before), ("then", after)):
        verdict = report.analysis.verdict
        text = f"{name}: path following {'yes' if verdict.follows else 'no'}. {verdict.reason}"
        console.print(text, markup=False, highlight=False, soft_wrap=True)
    for name, report, other in (("as it is", before, after), ("then", after, before)):
        for remark in report.remarks:
            if remark not in other.remarks:
                console.print(f"{name}: {remark}", markup=False, highlight=False, soft_wrap=True)
    console.print()


def _rows(report: Report) -> list[tuple[str, str]]:
    a, hull = report.analysis, report.vehicle.dynamics
    rows = [("rank", str(a.rank)), ("redundant", str(a.redundancy))]
    for i, extent in enumerate(a.extents or ()):
        unit = "N" if i < a.subspaces.axes.forces else "N m"
        low, high = extent.isolated
        rows.append((f"{extent.name} alone, {unit}", f"{_number(low)} .. {_number(high)}"))
    for name, cost in zip(a.subspaces.axes.names, a.component_costs, strict=True):
        rows.append((f"{name} costs, N/N", _number(float(cost))))
    i = a.indices
    rows += [
        ("isotropy", _number(i.isotropy)),
        ("energy", _number(i.energy)),
        ("robustness", _number(i.robustness)),
        ("every wrench up to, N", "" if i.weakest is None else _number(i.weakest)),
        ("losses tolerated", str(i.tolerated_losses)),
        ("torques divided by, m", _number(a.subspaces.length_m)),
        ("righting moment, N m", _number(float(np.linalg.norm(hull.righting_moment)))),
        ("turns within, m", "" if report.turning is None else _number(report.turning.radius_m)),
        ("margins up to, m/s", "" if report.critical is None else _number(report.critical.speed_m_s)),
    ]
    return rows


def _number(value: float) -> str:
    return "any" if value == np.inf else f"{value + 0.0:.3g}"
