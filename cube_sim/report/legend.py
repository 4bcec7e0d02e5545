"""What the curves and zones of a panel are called, in lines above its frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from cube_sim.report.markup import element, text
from cube_sim.report.panel import Panel

_SAMPLE, _APART = 21.0, 5.0
"""Width of the piece of line before a name, and what is left free behind it [px]."""


@dataclass(frozen=True)
class Entry:
    """A name in the legend.

    Attributes:
        x: where its sample begins, from the left end of the frame [px].
        width: with its sample and what is left free behind it [px].
        label: what is written.
        colour: CSS.
        style: of the curve, or "zone".
    """

    x: float
    width: float
    label: str
    colour: str
    style: str


def text_width(said: str) -> float:
    """Width of a legend's text [px], rather too much than too little: no fonts are measured here."""
    return sum(8.4 if each.isupper() else 6.8 for each in said)


def legend_lines(panel: Panel, taken: float, width: float) -> list[list[Entry]]:
    """The names in their order, in as many lines as they take, each at the right end of its line.

    Args:
        panel: whose curves and zones are named.
        taken: of the first line, where the title stands [px].
        width: of all lines [px].
    """
    named: dict[str, tuple[str, str]] = {}
    for curve in panel.curves:
        named.setdefault(curve.label, (curve.colour, curve.style))
    for zone in panel.zones:
        named.setdefault(zone.label, (zone.colour, "zone"))
    named.pop("", None)
    lines: list[list[Entry]] = [[]]
    room = width - taken
    for name, shown in named.items():
        label = _cut(name, width - _SAMPLE - _APART)
        entry = Entry(0.0, _SAMPLE + text_width(label) + _APART, label, *shown)
        if entry.width > room:
            lines.append([])
            room = width
        lines[-1].append(entry)
        room -= entry.width
    return [_at_the_right(line, width) for line in lines]


def _at_the_right(line: Sequence[Entry], width: float) -> list[Entry]:
    ends = width - sum(entry.width for entry in line)
    placed = []
    for entry in line:
        placed.append(replace(entry, x=ends))
        ends += entry.width
    return placed


def draw_legend(lines: Sequence[Sequence[Entry]], left: float, first: float, apart: float) -> Iterable[str]:
    """Draw the names.

    Args:
        lines: of `legend_lines`.
        left: end of the frame [px].
        first: where the first line is written [px].
        apart: from one line to the next [px].
    """
    for k, line in enumerate(lines):
        y = first + k * apart
        for entry in line:
            yield _sample(entry, left + entry.x, y)
            yield f'<text class="l" x="{left + entry.x + _SAMPLE:.0f}" y="{y:.0f}">{text(entry.label)}</text>'


def _sample(entry: Entry, x: float, y: float) -> str:
    middle = y - 4
    match entry.style:
        case "zone":
            return element("rect", x=f"{x:.0f}", y=f"{y - 9:.0f}", width=18, height=10, fill=entry.colour)
        case "dots":
            return element("circle", cx=f"{x + 9:.0f}", cy=f"{middle:.0f}", r=2.2, fill=entry.colour)
        case "crosses":
            return f'<path stroke="{entry.colour}" d="M{x + 6:.0f} {middle - 3:.0f}l6 6m0 -6l-6 6"/>'
    dash = ' stroke-dasharray="5 3"' if entry.style == "dashed" else ""
    wide = 1 if entry.style == "thin" else 2
    return f'<path stroke="{entry.colour}" stroke-width="{wide}"{dash} d="M{x:.0f} {middle:.0f}h18"/>'


def _cut(name: str, room: float) -> str:
    """A name that is longer than a line, without its middle: folders of runs differ at either end."""
    kept = name
    while text_width(kept) > room and len(kept) > 3:
        half = (len(kept) - 2) // 2
        kept = f"{kept[:half]}…{kept[-half:]}"
    return kept
