"""How the values of a check are spread over the samples of a sweep, and where its limit is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cube_sim.report import colours
from cube_sim.report.flat_plot import framed
from cube_sim.report.markup import element, number, text
from cube_sim.report.scale import Scale, scale_for
from cube_sim.spatial import Vector

WIDTH, HEIGHT = 456, 130
"""Of the frame [px]."""
BINS = 38
_TAIL = 4.0
"""Where the largest value is so many times what nine in ten stay below, the axis is logarithmic."""


@dataclass(frozen=True)
class Spread:
    """The values of one check.

    Attributes:
        name: of the check.
        unit: of the values.
        values: (n,), NaN where it could not be judged.
        passed: (n,) whether the sample passed it.
        relation: <= or >=.
        limit: None where samples have different ones.
    """

    name: str
    unit: str
    values: Vector
    passed: Vector
    relation: str
    limit: float | None


def histogram(spread: Spread) -> str:
    """As inline SVG; a line of words where nothing was judged."""
    known = np.isfinite(spread.values)
    values, passed = spread.values[known], spread.passed[known].astype(bool)
    if not len(values):
        return element("p", text(f"{spread.name}: in no sample it could be judged"))
    shown = values if spread.limit is None else np.append(values, spread.limit)
    lowest, highest = float(shown.min()), float(shown.max())
    tail = lowest > 0.0 and highest > _TAIL * float(np.quantile(values, 0.9)) + lowest
    across = scale_for(lowest, highest, WIDTH, logarithmic=tail)
    edges = np.linspace(0.0, WIDTH, BINS + 1)
    places = np.clip(across.to_pixels(values), 0.0, WIDTH)
    counts = [np.histogram(places[mask], edges)[0] for mask in (passed, ~passed)]
    most = int((counts[0] + counts[1]).max())
    up = Scale(0.0, 1.08 * most, HEIGHT)
    missing = len(spread.values) - len(values)
    above = f"{len(values)} samples" + (f", {missing} not judged" if missing else "")
    label = "" if spread.unit in ("", "1") else f"[{spread.unit}]"
    inside = [*_bars(counts, edges, up), *_limit(spread, across)]
    return framed(spread.name, across, up, inside, (label, ""), above=above)


def _bars(counts: list[Vector], edges: Vector, up: Scale) -> Iterator[str]:
    for index in range(BINS):
        base = HEIGHT
        for count, colour in zip(counts, (colours.SKY, colours.BAD), strict=True):
            size = float(up.to_pixels(np.array([float(count[index])]))[0])
            if size > 0.0:
                base -= size
                bar = {"x": f"{edges[index] + 0.5:.1f}", "y": f"{base:.1f}", "width": f"{edges[1] - 1.0:.1f}"}
                yield element("rect", fill=colour, height=f"{size:.1f}", **bar)


def _limit(spread: Spread, across: Scale) -> Iterator[str]:
    if spread.limit is None:
        return
    x = across.at(spread.limit)
    right = x < 0.6 * WIDTH
    yield element("path", d=f"M{x:.1f} 0V{HEIGHT}", stroke=colours.BLACK, class_="b")
    yield element(
        "text",
        text(f"{spread.relation} {number(spread.limit)}"),
        class_="a",
        fill=colours.BLACK,
        x=f"{x + (5 if right else -5):.1f}",
        y=12,
        text_anchor="start" if right else "end",
    )
