"""Checks drawn on what they judge: limit, worst sample, and the margin between them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cube_sim.report import colours
from cube_sim.report.markup import number, seconds, text
from cube_sim.report.panel import Guide, Panel
from cube_sim.report.scale import Scale

LEFT = 62
"""Where the drawing area of a panel begins [px]."""

SIGNS = {"<=": "≤", ">=": "≥"}


def captions(panel: Panel) -> list[tuple[str, str]]:
    """The checks drawn in a panel, in words, each with its colour."""
    said = []
    for guide in panel.guides:
        unit = f" {guide.unit}" if guide.unit else ""
        asked = f"{SIGNS[guide.relation]} {number(guide.limit)}{unit}"
        asked = f" {asked}" if guide.verdict == "PASS" else f", must be {asked}"
        words = f"{guide.verdict} {guide.name}: {number(guide.value)}{asked}"
        if guide.value is not None and guide.at_s is not None:
            words += f", margin {number(guide.margin)}, worst at {seconds(guide.at_s)}"
        said.append((words, guide.colour))
    return said


def limits(guides: Sequence[Guide], across: Scale, up: Scale, top: int) -> Iterable[str]:
    """Each limit over its window, and where no sample may be shaded; limits that lie on one another once."""
    return (_limit(guide, level, across, up, top) for guide in _once(guides) for level in drawn_levels(guide))


def drawn_levels(guide: Guide) -> tuple[float, ...]:
    """Numbers of the panel at which lines are drawn for a check: its limit, or what it names where that is another."""
    return guide.levels if guide.apart else (guide.limit,)


def points(guides: Sequence[Guide], across: Scale, up: Scale, top: int) -> Iterable[str]:
    """Of each check the sample that speaks most against it, its value, and the margin as a line from limit to value."""
    bottom = top + up.pixels
    written: list[tuple[float, float, float]] = []
    for guide in guides:
        if guide.value is None or guide.at_s is None or guide.margin is None:
            continue
        x = LEFT + across.at(guide.at_s)
        if guide.apart:
            if guide.at_value is not None:
                y = bottom - up.at(guide.at_value)
                yield f'<circle class="p" stroke="{guide.colour}" cx="{x:.1f}" cy="{y:.1f}" r="4"/>'
            continue
        limit, value = bottom - up.at(guide.limit), bottom - up.at(guide.value)
        yield f'<path class="w" stroke="{guide.colour}" d="M{x:.1f} {value:.1f}V{limit:.1f}"/>'
        if guide.at_value is not None and guide.at_value != guide.value:
            start, end = LEFT + across.at(guide.start_s), LEFT + across.at(guide.end_s)
            yield f'<path class="v" stroke="{guide.colour}" d="M{start:.1f} {value:.1f}H{end:.1f}"/>'
        if guide.at_value is not None:
            y = bottom - up.at(guide.at_value)
            yield f'<circle class="p" stroke="{guide.colour}" cx="{x:.1f}" cy="{y:.1f}" r="4"/>'
        said = f"margin {number(guide.margin)}"
        wide = 6.7 * len(said)
        beside = x + 8 if x + 8 + wide < LEFT + across.pixels else max(x - 8 - wide, LEFT + 4)
        middle = (value + limit) / 2 + 4
        if abs(value - limit) < 30:
            # Between them a line would be struck through.
            above = min(value, limit) - 8
            middle = above if above >= top + 12 else max(value, limit) + 16
        middle = _free(middle, [y for y, a, b in written if a < beside + wide and beside < b], top + 12, bottom - 5)
        written.append((middle, beside, beside + wide))
        yield f'<text class="a" fill="{guide.colour}" x="{beside:.1f}" y="{middle:.1f}">{text(said)}</text>'


def _once(guides: Sequence[Guide]) -> list[Guide]:
    """Of limits that lie on one another, the one that fares worst."""
    found: dict[tuple[object, ...], Guide] = {}
    for guide in guides:
        key = (guide.relation, drawn_levels(guide), guide.start_s, guide.end_s)
        if key not in found or guide.verdict != "PASS":
            found[key] = guide
    return list(found.values())


def _limit(guide: Guide, level: float, across: Scale, up: Scale, top: int) -> str:
    """The limit, or another level, over its window, and the forbidden side shaded."""
    start, end = LEFT + across.at(guide.start_s), LEFT + across.at(guide.end_s)
    y = top + up.pixels - up.at(level)
    start_y, end_y = (top, y) if guide.relation == "<=" else (y, top + up.pixels)
    colour = colours.of_verdict(guide.verdict)
    line = f'<path class="b" stroke="{colour}" d="M{start:.1f} {y:.1f}H{end:.1f}"/>'
    if not guide.every_sample:
        return line
    box = f'x="{start:.1f}" y="{start_y:.1f}" width="{end - start:.1f}" height="{end_y - start_y:.1f}"'
    return f'<rect class="x" {box}/>{line}'


def _free(wanted: float, written: Sequence[float], top: float, bottom: float) -> float:
    """The place nearest to the wanted one at which no line of text stands yet."""
    wanted = min(max(wanted, top), bottom)
    places = [wanted + sign * 12.5 * index for index in range(2 * len(written) + 1) for sign in (1, -1)]
    free = [y for y in places if top <= y <= bottom and all(abs(y - other) >= 12 for other in written)]
    return free[0] if free else wanted
