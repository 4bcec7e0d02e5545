"""Where samples fail: over two of what was varied, or over pairs of lost thrusters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cube_sim.report import colours
from cube_sim.report.flat_plot import framed
from cube_sim.report.markup import element, number, text
from cube_sim.report.scale import scale_for
from cube_sim.spatial import Vector

WIDTH, HEIGHT = 980, 380
MOST_POINTS = 3000
"""So many samples that pass are drawn at most, evenly from all; all others always."""
CELL = 44


@dataclass(frozen=True)
class Axis:
    """One axis of the map.

    Attributes:
        name: what was varied.
        values: (n,).
    """

    name: str
    values: Vector


def failure_map(across: Axis, up: Axis, samples: Sequence[int], verdicts: Sequence[str], reasons: Sequence[str]) -> str:
    """A point for each sample, as inline SVG; those that do not pass are drawn last and say why.

    Args:
        across: what is to the right.
        up: what is upwards.
        samples: numbers of the samples.
        verdicts: of each.
        reasons: why it did not pass.
    """
    known = np.isfinite(across.values) & np.isfinite(up.values)
    if not known.any():
        return ""
    x = scale_for(float(across.values[known].min()), float(across.values[known].max()), WIDTH)
    y = scale_for(float(up.values[known].min()), float(up.values[known].max()), HEIGHT)
    passed = [i for i in np.flatnonzero(known).tolist() if verdicts[i] == "PASS"]
    others = [i for i in np.flatnonzero(known).tolist() if verdicts[i] != "PASS"]
    shown = passed[:: max(1, -(-len(passed) // MOST_POINTS))]
    above = f"{len(passed)} pass" + (f", {len(shown)} of them drawn" if len(shown) < len(passed) else "")
    right, down = x.to_pixels(across.values), HEIGHT - y.to_pixels(up.values)
    points = _points([*shown, *others], right, down, samples, verdicts, reasons)
    title = "Failure map: red fails, amber could not be judged"
    return framed(title, x, y, points, (across.name, up.name), above=f"{above}, {len(others)} do not")


def _points(
    which: Sequence[int], x: Vector, y: Vector, samples: Sequence[int], verdicts: Sequence[str], reasons: Sequence[str]
) -> Iterator[str]:
    for i in which:
        verdict = verdicts[i]
        said = element("title", text(f"sample {samples[i]}: {verdict}  {reasons[i]}".strip()))
        fine = verdict == "PASS"
        yield element(
            "circle",
            said,
            cx=f"{x[i]:.1f}",
            cy=f"{y[i]:.1f}",
            r=2.2 if fine else 3.4,
            fill=colours.SKY if fine else colours.of_verdict(verdict),
            fill_opacity=0.55 if fine else 0.9,
        )


def lost_map(thrusters: Sequence[str], lost: Sequence[frozenset[str]], passed: Sequence[bool]) -> str:
    """Share of samples that pass, of those in which two thrusters are lost, or one on the diagonal, and maybe others.

    Args:
        thrusters: names.
        lost: of each sample.
        passed: whether it passed.
    """
    m, parts = len(thrusters), []
    for i, one in enumerate(thrusters):
        parts.append(element("text", text(one), class_="n", x=-6, y=f"{(i + 0.5) * CELL + 4}", text_anchor="end"))
        parts.append(element("text", text(one), class_="n", x=f"{(i + 0.5) * CELL}", y=-6, text_anchor="middle"))
        for j, other in enumerate(thrusters):
            both = [good for gone, good in zip(lost, passed, strict=True) if one in gone and other in gone]
            if both:
                parts.append(_cell(i, j, both, f"{one} lost" if i == j else f"{one} and {other} lost"))
    size = m * CELL
    title = "Share of samples that pass with these lost, others maybe too; one alone on the diagonal"
    heading = element("text", text(title), class_="h", x=-40, y=-26)
    view = f"-44 -44 {max(size + 60, 640)} {size + 52}"
    return element("svg", heading + "".join(parts), viewBox=view, class_="plan", role="img", aria_label=title)


def _cell(i: int, j: int, both: Sequence[bool], words: str) -> str:
    share = sum(both) / len(both)
    colour = colours.GOOD if share == 1.0 else colours.BAD if share == 0.0 else colours.ORANGE
    place = {"x": i * CELL + 1, "y": j * CELL + 1, "width": CELL - 2, "height": CELL - 2}
    said = element("title", text(f"{words}: {sum(both)} of {len(both)} samples pass"))
    shade = element("rect", said, fill=colour, fill_opacity=f"{0.25 + 0.6 * abs(share - 0.5):.2f}", **place)
    middle = {"x": f"{(i + 0.5) * CELL}", "y": f"{(j + 0.5) * CELL + 4}", "text_anchor": "middle"}
    return shade + element("text", f"{number(100.0 * share, 3)} %", class_="n", **middle)
