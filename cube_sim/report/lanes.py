"""States over time as coloured lanes, one below the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cube_sim.report.decimation import Values
from cube_sim.report.drawing import LEFT, RIGHT, WIDE, gaps
from cube_sim.report.legend import text_width
from cube_sim.report.markup import element, text
from cube_sim.report.panel import TimeAxis
from cube_sim.report.scale import Scale

_HEIGHT, _ABOVE, _BELOW = 17, 36, 20


@dataclass(frozen=True)
class StateLane:
    """One state that changes now and then.

    Attributes:
        name: of the lane.
        times: (n,) increasing [s].
        states: (n,) numbers of the states, -1 where nobody knows; of those that share a pixel the largest is shown.
        labels: name of each state.
        colours: of each state, CSS; "" leaves it blank.
    """

    name: str
    times: Values
    states: NDArray[np.integer]
    labels: tuple[str, ...]
    colours: tuple[str, ...]


def draw_lanes(title: str, lanes: Sequence[StateLane], axis: TimeAxis) -> str:
    """Draw lanes over the time axis of the page."""
    # As far in as the panels, if the names leave room.
    left = max(LEFT, 8 + round(max((text_width(lane.name) for lane in lanes), default=0.0) * 0.78))
    across = Scale(axis.start_s, axis.end_s, WIDE - left - RIGHT)
    bottom = _ABOVE + _HEIGHT * len(lanes)
    parts = [f'<text class="h" x="{left}" y="12">{text(title)}</text>', _legend(lanes)]
    for value, label in across.ticks(12):
        x = f"{left + across.at(value):.1f}"
        parts.append(f'<path class="g" d="M{x} {_ABOVE}V{bottom}"/>')
        parts.append(f'<text class="n" x="{x}" y="{bottom + 13}" text-anchor="middle">{text(label)}</text>')
    for index, lane in enumerate(lanes):
        y = _ABOVE + _HEIGHT * index
        parts.append(f'<text class="n" x="{left - 5}" y="{y + 12}" text-anchor="end">{text(lane.name)}</text>')
        parts.append(f'<path class="g" d="M{left} {y + _HEIGHT}H{left + across.pixels:.0f}"/>')
        parts += [
            element("rect", x=f"{left + a:.0f}", y=y + 2, width=f"{b - a:.0f}", height=_HEIGHT - 4, fill=colour)
            for a, b, colour in _blocks(lane, across, axis.end_s)
        ]
    parts += gaps(axis, across, left, _ABOVE, _HEIGHT * len(lanes))
    for mark in axis.marks:
        x = f"{left + across.at(mark.t):.1f}"
        parts.append(f'<path class="m" stroke="{mark.colour}" d="M{x} {_ABOVE}V{bottom}"/>')
    return element(
        "svg", "".join(parts), viewBox=f"0 0 {WIDE} {bottom + _BELOW}", class_="lanes", role="img", aria_label=title
    )


def _legend(lanes: Sequence[StateLane]) -> str:
    """The states that occur."""
    seen: dict[str, str] = {}
    for lane in lanes:
        for state in np.unique(lane.states).tolist():
            if 0 <= state < len(lane.labels) and lane.colours[state]:
                seen.setdefault(lane.labels[state], lane.colours[state])
    parts, x = [], WIDE - RIGHT
    for label, colour in reversed(seen.items()):
        x -= 26 + round(text_width(label))
        parts.append(f'<rect x="{x}" y="20" width="18" height="10" fill="{colour}"/>')
        parts.append(f'<text class="l" x="{x + 21}" y="29">{text(label)}</text>')
    return "".join(parts)


def _blocks(lane: StateLane, across: Scale, end_s: float) -> list[tuple[float, float, str]]:
    """Where which colour stands: start and end [px], a pixel wide at least."""
    inside = (lane.times >= across.low) & (lane.times <= end_s)
    if not inside.any():
        return []
    column = np.floor(across.to_pixels(lane.times[inside])).astype(int)
    begins = np.flatnonzero(np.concatenate([[True], np.diff(column) > 0]))
    state = np.maximum.reduceat(lane.states[inside], begins)
    at = column[begins]
    changes = np.flatnonzero(np.concatenate([[True], np.diff(state) != 0]))
    # The last state lasts for as long as a row stands for, a pixel at least.
    period = float(np.median(np.diff(lane.times))) if len(lane.times) > 1 else 0.0
    end = max(across.at(float(lane.times[inside][-1]) + period), at[-1] + 1.0)
    starts, ends = at[changes], np.append(at[changes][1:], end)
    found = []
    for a, b, code in zip(starts.tolist(), ends.tolist(), state[changes].tolist(), strict=True):
        colour = "" if code < 0 else lane.colours[code] if code < len(lane.colours) else "#000"
        if colour:
            found.append((a, b, colour))
    return found
