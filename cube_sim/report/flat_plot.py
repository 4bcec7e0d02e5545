"""A frame with two axes that have nothing to do with time, as inline SVG."""

from __future__ import annotations

from collections.abc import Iterable

from cube_sim.report.markup import element, text
from cube_sim.report.scale import Scale

LEFT, RIGHT, TOP, BOTTOM = 62, 14, 24, 36
"""Room beside the frame [px]."""


def framed(
    title: str, across: Scale, up: Scale, inside: Iterable[str], labels: tuple[str, str], *, above: str = ""
) -> str:
    """A plot.

    Args:
        title: what it shows.
        across: its horizontal axis.
        up: its vertical one; pixels count downwards from its top.
        inside: markup whose coordinates count from the upper left corner of the frame [px].
        labels: of the axes, what is across first.
        above: a remark beside the title.
    """
    width, height = across.pixels, up.pixels
    parts = [
        element("text", text(title) + element("tspan", f"  {text(above)}", class_="e"), class_="h", x=0, y=-9),
        *_ticks_across(across, height),
        *_ticks_up(up, width),
        element("rect", class_="f", x=0, y=0, width=f"{width:g}", height=f"{height:g}"),
        *inside,
        element("text", text(labels[0]), class_="l", x=f"{width:g}", y=f"{height + 31:g}", text_anchor="end"),
        element("text", text(labels[1]), class_="l", x=f"{width:g}", y=-9, text_anchor="end") if labels[1] else "",
    ]
    view = f"{-LEFT} {-TOP} {width + LEFT + RIGHT:g} {height + TOP + BOTTOM:g}"
    return element("svg", "".join(parts), viewBox=view, class_="plan", role="img", aria_label=title)


def _ticks_across(scale: Scale, height: float) -> Iterable[str]:
    for value, label in scale.ticks(6):
        x = f"{scale.at(value):.1f}"
        yield element("path", class_="g", d=f"M{x} 0v{height:g}")
        yield element("text", text(label), class_="n", x=x, y=f"{height + 14:g}", text_anchor="middle")


def _ticks_up(scale: Scale, width: float) -> Iterable[str]:
    for value, label in scale.ticks(4):
        y = f"{scale.pixels - scale.at(value):.1f}"
        yield element("path", class_="g", d=f"M0 {y}h{width:g}")
        yield element("text", text(label), class_="n", x=-6, y=y, dy="3.5", text_anchor="end")
