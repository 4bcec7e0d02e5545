"""Limits of checks and events as lines in the plots of the view."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import rerun as rr

from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.drawn import Drawn
from cube_sim.recording.rerun.plots import (
    ATTITUDE,
    BATTERY,
    ERROR,
    FINS,
    FORCE,
    HEADING,
    HEIGHT,
    MOMENT,
    NAVIGATION,
    THRUSTERS,
    VELOCITY,
    WATER,
    Curves,
)
from cube_sim.recording.rerun.story import Limit, Story

_MOST_NAMED = 6
"""So many events are named in the legend of a plot; where there are more, none is (choice)."""


def log_guides(recording: rr.RecordingStream, drawn: Drawn, curves: Sequence[Curves], line: str) -> None:
    """Draw what is known before the run.

    Args:
        recording: into which.
        drawn: the run.
        curves: those of the run; a limit goes to the plot of its signal.
        line: name of the timeline.
    """
    places, story = drawn.places, drawn.story
    for number, limit in enumerate(story.limits):
        plot = _plot_of(limit, curves)
        if plot is None:
            continue
        entity = places.at(f"{plot}/limit_{number}")
        style = rr.SeriesLines(names=[f"limit: {limit.text}"], colors=[palette.LIMIT], widths=[1.0])
        recording.log(entity, style, static=True)
        _send(recording, entity, line, [limit.start_s, limit.end_s], [limit.value, limit.value])
    for plot, (low, high) in _extents(drawn).items():
        if not any(curve.entity.startswith(plot) for curve in curves):
            continue
        for number, event in enumerate(story.events):
            entity = places.at(f"{plot}/event_{number}")
            name = f"{event.t:g} s: {event.text}" if len(story.events) <= _MOST_NAMED else "event"
            # Both ends fall on one pixel: gathered into one number they would be no line.
            style = rr.SeriesLines(
                names=[name],
                colors=[palette.EVENT],
                widths=[1.0],
                aggregation_policy=rr.components.AggregationPolicy.Off,
            )
            recording.log(entity, style, static=True)
            # Upright but for a nanosecond.
            _send(recording, entity, line, [event.t, event.t + 1e-9], [low, high])


def shown_error_m(story: Story, otherwise: float) -> float:
    """What the closer plot of the path error shows either side of 0: a little beyond the largest limit of a check."""
    limits = [each.value for each in story.limits if each.signal == "path_error.cross_track" and each.value > 0]
    return 1.2 * max(limits) if limits else otherwise


def _extents(drawn: Drawn) -> Mapping[str, tuple[float, float]]:
    """Lower and upper end of an event's line, by plot: within what its curves may be expected to cover (choice)."""
    story, measures = drawn.story, drawn.measures
    force, speed = 0.2 * measures.largest_N, story.speed_m_s or 0.3
    heights = drawn.points[:, 2] if len(drawn.points) else np.zeros(1)
    return {
        ERROR: _even(_largest(story, "path_error.cross_track", 0.1)),
        ATTITUDE: _even(_largest(story, "path_error.attitude", 0.1)),
        FORCE: _even(force),
        MOMENT: _even(force * measures.reach),
        THRUSTERS: _even(force),
        FINS: _even(10.0),
        VELOCITY: (0.0, speed),
        HEIGHT: (float(heights.min()), float(heights.max())),
        HEADING: _even(180.0),
        WATER: _even(max(0.1, 0.3 * speed)),
        NAVIGATION: _even(0.1),
        BATTERY: (0.0, 100.0),
    }


def _plot_of(limit: Limit, curves: Sequence[Curves]) -> str | None:
    """The plot that shows what the check judges; None where none does."""
    for curve in curves:
        if f"{curve.channel}.{curve.field}" == limit.signal and curve.derived is None:
            count = len(curve.names)
            if (limit.column is None and count == 1 and not curve.columns) or limit.column in (
                curve.columns or range(count)
            ):
                return curve.entity.rpartition("/")[0] if curve.entity.count("/") > 2 else curve.entity
    return None


def _largest(story: Story, signal: str, otherwise: float) -> float:
    return max((abs(limit.value) for limit in story.limits if limit.signal == signal), default=otherwise)


def _even(size: float) -> tuple[float, float]:
    return -size, size


def _send(
    recording: rr.RecordingStream, entity: str, line: str, times: Sequence[float], values: Sequence[float]
) -> None:
    stamps = np.rint(np.array(times) * 1e9).astype("timedelta64[ns]")
    columns = rr.Scalars.columns(scalars=np.array(values))
    recording.send_columns(entity, [rr.TimeColumn(line, duration=stamps)], columns)
