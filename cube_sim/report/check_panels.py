"""The checks, each drawn on what it judges: limit, worst sample, margin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.report import colours
from cube_sim.report.guides import drawn_levels
from cube_sim.report.judged_quantity import JudgedQuantity, judged_quantities
from cube_sim.report.panel import Curve, Guide, Panel, Shade
from cube_sim.report.subject import Subject
from cube_sim.verdict import CheckResult

_SPREAD = 30.0
"""Where most samples are so much smaller than the largest or the limit, the axis is logarithmic (choice)."""


def check_panels(subjects: Sequence[Subject]) -> list[Panel]:
    """A panel for each quantity that is judged, in the order of the checks."""
    curves: dict[str, list[Curve]] = {}
    guides: dict[str, list[Guide]] = {}
    shades: dict[str, list[Shade]] = {}
    first: dict[str, JudgedQuantity] = {}
    for subject in subjects:
        alone = len(subjects) == 1
        drawn = set()
        for check, result in zip(subject.scenario.checks, subject.results, strict=True):
            for quantity in judged_quantities(subject, check):
                title = quantity.title
                first.setdefault(title, quantity)
                if title not in drawn:
                    drawn.add(title)
                    rows = quantity.rows
                    colour = colours.BLUE if alone else subject.colour
                    label = "" if alone else subject.label
                    curve = Curve(label, rows[:, 0], rows[:, 1], colour, steps=quantity.steps)
                    curves.setdefault(title, []).append(curve)
                guides.setdefault(title, []).append(_guide(quantity, result, subject, alone))
                shades.setdefault(title, []).extend(_shades(quantity, subject))
    return [_panel(quantity, curves[title], guides[title], shades[title]) for title, quantity in first.items()]


def _shades(quantity: JudgedQuantity, subject: Subject) -> list[Shade]:
    """The windows of a check that draws no limit, where they are not the whole run."""
    whole = 0.0, subject.scenario.duration_s
    return [Shade(*window, colours.LOOKED_AT) for window in quantity.windows if window != whole]


def _guide(quantity: JudgedQuantity, result: CheckResult, subject: Subject, alone: bool) -> Guide:
    at_value = None if result.at_s is None else quantity.at(result.at_s)
    if quantity.as_samples and result.value is not None:
        at_value = result.value
    return Guide(
        result.name if alone else f"{subject.label}, {result.name}",
        result.relation,
        result.limit,
        quantity.start_s,
        quantity.end_s,
        result.verdict,
        result.value,
        result.at_s,
        at_value,
        result.margin,
        colours.of_verdict(result.verdict) if alone else subject.colour,
        quantity.every_sample,
        quantity.apart,
        result.unit if quantity.apart and result.unit != "1" else "",
        quantity.levels,
    )


def _panel(
    quantity: JudgedQuantity, curves: Sequence[Curve], guides: Sequence[Guide], shades: Sequence[Shade]
) -> Panel:
    values = np.concatenate([curve.values for curve in curves])
    values = values[np.isfinite(values)]
    above = values[values > 0]
    logarithmic, drawn = False, [level for guide in guides for level in drawn_levels(guide)]
    if len(above) and not quantity.codes and np.all(values >= 0) and all(level >= 0 for level in drawn):
        largest = max([float(above.max()), *drawn])
        logarithmic = largest > _SPREAD * float(np.median(above))
    focus = min(g.start_s for g in guides), max(g.end_s for g in guides)
    flown = any(np.any((curve.times >= focus[0]) & np.isfinite(curve.values)) for curve in curves)
    note = ""
    if quantity.codes:
        shown = sorted({int(value) for value in values} | {int(level) for level in drawn})
        note = ", ".join(f"{code} {quantity.codes[code]}" for code in shown if 0 <= code < len(quantity.codes))
    return Panel(
        quantity.title,
        quantity.unit,
        tuple(curves),
        shades=tuple(dict.fromkeys(shades)),
        guides=tuple(guides),
        logarithmic=logarithmic,
        note=f"({note})" if note else "",
        focus=None if logarithmic or not flown else focus,
    )
