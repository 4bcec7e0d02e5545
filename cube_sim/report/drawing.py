"""A panel as inline SVG.

Curves are drawn in tenths of a pixel, as whole numbers relative to the point before: short, and still finer than any
screen or printer resolves on a page.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from cube_sim.report import colours
from cube_sim.report.decimation import Values, decimated, held, stepped
from cube_sim.report.guides import LEFT, drawn_levels, limits, points
from cube_sim.report.legend import draw_legend, legend_lines, text_width
from cube_sim.report.markup import element, text
from cube_sim.report.panel import Curve, Mark, Panel, TimeAxis, Zone
from cube_sim.report.scale import Scale, scale_for

RIGHT, TOP, BOTTOM = 14, 36, 20
WIDE, HALF = 1080, 532
_LINE, _LINES, _HEAD_EM = 13, 2, 7.4
"""Height of a line above the frame, how many of them have room there, width of a character of the title [px]."""
_FINER = 10
_STROKES = {"solid": "c", "dashed": "c d", "thin": "c t"}


def draw(panel: Panel, axis: TimeAxis, width: int = WIDE) -> str:
    """Draw a panel over its time axis."""
    across = Scale(axis.start_s, axis.end_s, width - LEFT - RIGHT)
    up = _vertical(panel)
    entries = legend_lines(panel, _HEAD_EM * _title_length(panel, up), across.pixels)
    above = _LINE * max(len(entries) - _LINES, 0)
    parts = [
        *_head(panel, up, _LINE - above),
        *draw_legend(entries, LEFT, _LINE - above, _LINE),
        *_phases(axis, across, panel.height),
        *_frame(panel, across, up, width),
        *(_zone(zone, across, up) for zone in panel.zones),
        *gaps(axis, across, LEFT, TOP, panel.height),
        *_marks(axis, across, panel.height),
        *limits(panel.guides, across, up, TOP),
        *(_curve(curve, across, up, axis.end_s) for curve in panel.curves),
        *points(panel.guides, across, up, TOP),
    ]
    whole = TOP + panel.height + BOTTOM
    return element(
        "svg",
        "".join(parts),
        viewBox=f"0 {-above} {width} {whole + above}",
        class_="time" if width == WIDE else "time half",
        role="img",
        aria_label=panel.title,
        data_t0=f"{axis.start_s:.9g}",
        data_t1=f"{axis.end_s:.9g}",
        data_y0=f"{up.low:.9g}",
        data_y1=f"{up.high:.9g}",
        data_log="1" if up.logarithmic else None,
        data_h=panel.height,
        data_unit=panel.unit,
    )


def _vertical(panel: Panel) -> Scale:
    seen: list[float] = list(panel.include)
    positive = []
    for curve in panel.curves:
        shown = np.isfinite(curve.values)
        if panel.focus is not None:
            shown &= (curve.times >= panel.focus[0]) & (curve.times <= panel.focus[1])
        sound = curve.values[shown]
        if len(sound):
            seen += [float(sound.min()), float(sound.max())]
            above = sound[sound > 0]
            positive += [float(above.min())] if len(above) else []
    for guide in panel.guides:
        value = () if guide.apart or guide.value is None else (guide.value,)
        seen += [*drawn_levels(guide), *value]
    for zone in panel.zones:
        if zone.shown:
            edges = np.concatenate([zone.low, zone.high])
            edges = edges[np.isfinite(edges)]
            seen += [float(edges.min()), float(edges.max())] if len(edges) else []
    positive += [value for value in seen if value > 0]
    lowest, highest = min(seen, default=math.nan), max(seen, default=math.nan)
    if panel.logarithmic and positive:
        return scale_for(min(positive), highest, panel.height, logarithmic=True)
    return scale_for(lowest, highest, panel.height)


def _frame(panel: Panel, across: Scale, up: Scale, width: int) -> Iterable[str]:
    right, bottom = LEFT + across.pixels, TOP + panel.height
    for shade in panel.shades:
        start, end = across.at(shade.start_s), across.at(shade.end_s)
        yield element(
            "rect",
            x=f"{LEFT + start:.1f}",
            y=TOP,
            width=f"{max(end - start, 1.0):.1f}",
            height=panel.height,
            fill=shade.colour,
        )
    for value, label in up.ticks(max(4, panel.height // 28)):
        y = f"{bottom - up.at(value):.1f}"
        zero = " z" if value == 0 and not up.logarithmic else ""
        yield f'<path class="g{zero}" d="M{LEFT} {y}H{right:.0f}"/>'
        yield f'<text class="n" x="{LEFT - 5}" y="{float(y) + 3.5:.1f}" text-anchor="end">{text(label)}</text>'
    for value, label in across.ticks(12 if width == WIDE else 6):
        x = f"{LEFT + across.at(value):.1f}"
        yield f'<path class="g" d="M{x} {TOP}V{bottom}"/>'
        yield f'<text class="n" x="{x}" y="{bottom + 13}" text-anchor="middle">{text(label)}</text>'
    yield f'<text class="n" x="{LEFT - 12}" y="{bottom + 13}" text-anchor="end">t [s]</text>'
    yield f'<rect class="f" x="{LEFT}" y="{TOP}" width="{across.pixels:.0f}" height="{panel.height}"/>'


def _head(panel: Panel, up: Scale, y: float) -> Iterable[str]:
    note = f'<tspan class="e"> {text(panel.note)}</tspan>' if panel.note else ""
    kind = ', <tspan class="e">logarithmic</tspan>' if up.logarithmic else ""
    yield f'<text class="h" x="{LEFT}" y="{y}">{text(panel.title)}{text(_unit(panel))}{kind}{note}</text>'


def _unit(panel: Panel) -> str:
    return "" if panel.unit in ("", "1") else f" [{panel.unit}]"


def _title_length(panel: Panel, up: Scale) -> int:
    return len(panel.title + _unit(panel) + panel.note) + (13 if up.logarithmic else 0)


def _zone(zone: Zone, across: Scale, up: Scale) -> str:
    """Filled between its edges, these taken once a pixel."""
    start, end = max(across.low, float(zone.times[0])), min(across.high, float(zone.times[-1]))
    if zone.steps:
        end = across.high
    if not end > start or not len(zone.times):
        return ""
    columns = np.linspace(start, end, max(2, int(across.pixels * (end - start) / (across.high - across.low))))
    edges = np.column_stack([zone.times, zone.low, zone.high])
    if zone.steps:
        both = held(edges, columns)
    else:
        both = np.column_stack([np.interp(columns, zone.times, edge) for edge in (zone.low, zone.high)])
    low, high = np.clip(both, up.low, up.high).T
    sound = np.isfinite(low) & np.isfinite(high) & (high > low)
    shapes = []
    for first, last in np.flatnonzero(np.diff(np.concatenate([[False], sound, [False]]))).reshape(-1, 2).tolist():
        x = across.to_pixels(np.concatenate([columns[first:last], columns[first:last][::-1]]))
        y = up.pixels - up.to_pixels(np.concatenate([low[first:last], high[first:last][::-1]]))
        shapes.append(path_data(x, y) + "z")
    if not shapes:
        return ""
    return _fine(element("path", d="".join(shapes), fill=zone.colour), across, up)


def _curve(curve: Curve, across: Scale, up: Scale, end_s: float) -> str:
    times, values = (
        stepped(curve.times, curve.values, end_s) if curve.steps else (curve.times, np.asarray(curve.values))
    )
    x = across.to_pixels(times)
    y = up.pixels - up.to_pixels(np.where(np.isfinite(values), values, np.nan))
    if curve.style in ("dots", "crosses"):
        sound = np.isfinite(y) & (x >= 0) & (x <= across.pixels)
        dot = "h0" if curve.style == "dots" else "m-30 -30l60 60m0 -60l-60 60"
        places = np.unique(np.rint(np.column_stack([x, y])[sound] * _FINER).astype(int), axis=0)
        d = "".join(f"M{a} {b}{dot}" for a, b in places.tolist())
        return _fine(
            element("path", class_="o" if curve.style == "dots" else "k", d=d, stroke=curve.colour), across, up
        )
    pieces = [
        path_data(x[chosen], y[chosen]) for chosen in decimated(x, y, int(across.pixels), 0.0 if curve.steps else 0.4)
    ]
    if not pieces:
        return ""
    label = curve.label or None
    return _fine(
        element("path", class_=_STROKES[curve.style], d="".join(pieces), stroke=curve.colour, data_label=label),
        across,
        up,
    )


def _fine(shape: str, across: Scale, up: Scale) -> str:
    """Drawn in tenths of a pixel, and cut off at the frame."""
    wide, high = round(across.pixels), round(up.pixels)
    box = f'x="{LEFT}" y="{TOP}" width="{wide}" height="{high}" viewBox="0 0 {wide * _FINER} {high * _FINER}"'
    return f"<svg {box}>{shape}</svg>"


def path_data(x: Values, y: Values) -> str:
    """A line through points [px], as whole tenths of a pixel; points on a level line between two are left out."""
    points = np.rint(np.column_stack([x, y]) * _FINER).astype(np.int64)
    if len(points) > 2:
        level = (points[1:-1, 1] == points[:-2, 1]) & (points[1:-1, 1] == points[2:, 1])
        points = points[np.concatenate([[True], ~level, [True]])]
    first = f"M{points[0, 0]} {points[0, 1]}"
    if len(points) == 1:
        return first + "h0"
    steps = " ".join(map(str, np.diff(points, axis=0).ravel().tolist()))
    return f"{first}l{steps}".replace(" -", "-")


def gaps(axis: TimeAxis, across: Scale, left: float, top: float, height: float) -> Iterable[str]:
    """Hatched from top to bottom: nothing is recorded there."""
    for start_s, end_s in axis.gaps:
        start, end = across.at(start_s), across.at(end_s)
        wide = f"{max(end - start, 1.0):.1f}"
        yield element("rect", class_="gap", x=f"{left + start:.1f}", y=top, width=wide, height=height)


def _phases(axis: TimeAxis, across: Scale, height: int) -> Iterable[str]:
    """Every second leg shaded, and the names of those that have room for them."""
    for number, (start_s, end_s, name) in enumerate(axis.phases):
        x, end = LEFT + across.at(start_s), LEFT + across.at(end_s)
        if number % 2:
            yield element("rect", x=f"{x:.1f}", y=TOP, width=f"{end - x:.1f}", height=height, fill=colours.EVERY_SECOND)
        shown = name if text_width(name) + 6 <= end - x else ""
        yield f'<text class="ph" x="{x + 3:.1f}" y="{TOP + 10}">{text(shown)}</text>' if shown else ""


def _marks(axis: TimeAxis, across: Scale, height: int) -> Iterable[str]:
    for mark in axis.marks:
        x = LEFT + across.at(mark.t)
        yield f'<path class="m" stroke="{mark.colour}" d="M{x:.1f} {TOP}V{TOP + height}"/>'
    places = [(LEFT + across.at(mark.t), 0.0) for mark in axis.marks]
    for (x, _), mark, flag in flags(axis.marks, places):
        yield f'<text class="q" fill="{mark.colour}" x="{x:.1f}" y="{TOP - 3}">{text(flag)}</text>'


def flags(marks: Sequence[Mark], places: Sequence[tuple[float, float]]) -> list[tuple[tuple[float, float], Mark, str]]:
    """Where to write which flag: those too near to one another as one, at the first of them.

    Args:
        marks: in the order of time.
        places: of each [px].
    """
    found: list[tuple[tuple[float, float], Mark, str]] = []
    first = ""
    for mark, place in zip(marks, places, strict=True):
        if found and math.dist(found[-1][0], place) < 14 + 6 * len(found[-1][2]):
            at, leading, _ = found[-1]
            found[-1] = at, leading, f"{first}–{mark.flag}"
        else:
            first = mark.flag
            found.append((place, mark, first))
    return found
