"""The checks, each drawn on what it judges: limit, worst sample, margin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.report import colours
from cube_sim.report.judged_quantity import JudgedQuantity, judged_quantity
from cube_sim.report.panel import Curve, Guide, Panel
from cube_sim.report.subject import Subject
from cube_sim.verdict import CheckResult

_SPREAD = 30.0
"""Where most samples are so much smaller than the largest or the limit, the axis is logarithmic (choice)."""


def check_panels(subjects: Sequence[Subject]) -> list[Panel]:
    """A panel for each quantity that is judged, in the order of the checks."""
    curves: dict[str, list[Curve]] = {}
    guides: dict[str, list[Guide]] = {}
    first: dict[str, JudgedQuantity] = {}
    for subject in subjects:
        alone = len(subjects) == 1
        drawn = set()
        for check, result in zip(subject.scenario.checks, subject.results, strict=True):
            quantity = judged_quantity(subject, check)
            title = quantity.title
            first.setdefault(title, quantity)
            if title not in drawn:
                drawn.add(title)
                rows = quantity.rows
                colour = colours.BLUE if alone else subject.colour
                curve = Curve("" if alone else subject.label, rows[:, 0], rows[:, 1], colour)
                curves.setdefault(title, []).append(curve)
            guides.setdefault(title, []).append(_guide(quantity, result, subject, alone))
    return [_panel(quantity, curves[title], guides[title]) for title, quantity in first.items()]


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
    )


def _panel(quantity: JudgedQuantity, curves: Sequence[Curve], guides: Sequence[Guide]) -> Panel:
    values = np.concatenate([curve.values for curve in curves])
    values = values[np.isfinite(values)]
    above = values[values > 0]
    logarithmic = False
    if len(above) and not quantity.codes and np.all(values >= 0) and all(guide.limit >= 0 for guide in guides):
        largest = max(float(above.max()), *(guide.limit for guide in guides))
        logarithmic = largest > _SPREAD * float(np.median(above))
    focus = min(g.start_s for g in guides), max(g.end_s for g in guides)
    flown = any(np.any((curve.times >= focus[0]) & np.isfinite(curve.values)) for curve in curves)
    note = ""
    if quantity.codes:
        shown = sorted({int(value) for value in values} | {int(guide.limit) for guide in guides})
        note = ", ".join(f"{code} {quantity.codes[code]}" for code in shown if 0 <= code < len(quantity.codes))
    return Panel(
        quantity.title,
        quantity.unit,
        tuple(curves),
        guides=tuple(guides),
        logarithmic=logarithmic,
        note=f"({note})" if note else "",
        focus=None if logarithmic or not flown else focus,
    )
