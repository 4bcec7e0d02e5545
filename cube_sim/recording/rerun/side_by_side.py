"""How several runs are laid out in one view: one scene, one time, a curve for each run in the same plot."""

from __future__ import annotations

from collections.abc import Sequence

import rerun as rr
import rerun.blueprint as rrb

from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.blueprint import CLOSE_ERROR_M, Plots, scene, time_axis, whole
from cube_sim.recording.rerun.drawn import Drawn
from cube_sim.recording.rerun.guides import shown_error_m
from cube_sim.recording.rerun.places import Places
from cube_sim.recording.rerun.plots import (
    ATTITUDE,
    ERROR,
    FORCE,
    HEADING,
    HEALTH,
    HEIGHT,
    LANES,
    THRUSTERS,
    VELOCITY,
    curves,
)
from cube_sim.recording.rerun.scene import Look

_TRAILS = (palette.YELLOW, palette.SKY, palette.VERMILION, palette.GREEN, palette.PURPLE, palette.BLUE)
_PATHS = (palette.PATH, (120, 150, 175), (160, 130, 120), (120, 160, 140), (160, 130, 150), (120, 140, 180))
MOST_RUNS = len(_TRAILS)

_COMPARED = (
    (f"{ERROR}/along", "Along the path [m]"),
    (f"{ATTITUDE}/attitude", "Attitude error [rad]"),
    (f"{HEIGHT}/vehicle", "Height [m]"),
    (f"{HEADING}/flown", "Heading [deg]"),
)
"""Single numbers, a plot each."""


def looks(names: Sequence[str]) -> list[tuple[Places, Look]]:
    """Where each run of a view is and how it looks, by their names; of one run its usual place."""
    if len(names) == 1:
        return [(Places(), Look())]
    return [
        (Places(f"/{chr(ord('a') + index)}"), Look(_TRAILS[index], _PATHS[index], name, surface=index == 0))
        for index, name in enumerate(names)
    ]


def looks_of_vehicles(names: Sequence[str], surroundings: Sequence[bool]) -> list[tuple[Places, Look]]:
    """Where each vehicle of one run is and how it looks, by their names.

    Args:
        names: of the vehicles.
        surroundings: of each, whether what stands around it is drawn with it.
    """
    return [
        (
            Places(f"/{name}"),
            Look(_TRAILS[i % MOST_RUNS], _PATHS[i % MOST_RUNS], name, surface=i == 0, surroundings=around),
        )
        for i, (name, around) in enumerate(zip(names, surroundings, strict=True))
    ]


def side_by_side(runs: Sequence[Drawn], distances: Sequence[str] = ()) -> rrb.Blueprint:
    """Lay out several runs, or the vehicles of one.

    Args:
        runs: what is drawn of each.
        distances: entities of distances between vehicles.
    """
    durations = [drawn.story.duration_s for drawn in runs]
    known = [duration for duration in durations if duration is not None]
    longest = max(known) if len(known) == len(runs) else None
    plot = Plots(longest, Places())
    size = max(shown_error_m(drawn.story, CLOSE_ERROR_M) for drawn in runs)
    cross = _compared(f"{ERROR}/cross_track", runs)
    rows = [
        rrb.Horizontal(
            plot.of("Cross-track error [m]", *cross),
            plot.of(f"within {100 * size:.3g} cm", *cross, size=size),
        ),
        rrb.Tabs(*(plot.of(title, *_compared(entity, runs)) for entity, title in _COMPARED), active_tab=0),
        *([plot.of("Distance between vehicles [m]", distances, {})] if distances else []),
        *(_own_plots(drawn, longest) for drawn in runs),
    ]
    lanes = [_lanes(drawn, longest) for drawn in runs]
    left = rrb.Vertical(scene(runs, "/"), rrb.Horizontal(*lanes), row_shares=[1.0, 1.0])
    right = rrb.Vertical(*rows, row_shares=[1.0] * len(rows))
    return whole(rrb.Horizontal(left, right, column_shares=[5.0, 4.0]))


def _compared(entity: str, runs: Sequence[Drawn]) -> tuple[list[str], dict[str, rr.SeriesLines]]:
    """The entity of each run that has it, and its colour: that of the run's trail."""
    having = [drawn for drawn in runs if any(curve.entity == entity for curve in curves(drawn.channels))]
    places = {drawn.places.at(entity): drawn.look.trail for drawn in having}
    return list(places), {place: rr.SeriesLines.from_fields(colors=[colour]) for place, colour in places.items()}


def _own_plots(drawn: Drawn, duration_s: float | None) -> rrb.Container:
    plot, name = Plots(duration_s, drawn.places), drawn.look.name
    views = [
        plot(place, f"{name}: {title}")
        for place, title in ((THRUSTERS, "thrusters [N]"), (VELOCITY, "velocity [m/s]"), (FORCE, "force [N]"))
    ]
    return rrb.Tabs(*views, active_tab=0)


def _lanes(drawn: Drawn, duration_s: float | None) -> rrb.Container:
    places, name, time = drawn.places, drawn.look.name, time_axis(duration_s)
    views = [
        rrb.StateTimelineView(origin=places.at(LANES), name=f"{name}: allocation", time_view=time),
        rrb.StateTimelineView(origin=places.at(HEALTH), name=f"{name}: health", time_view=time),
        rrb.TextLogView(origin=places.log, name=f"{name}: log"),
    ]
    return rrb.Tabs(*views, rrb.TextDocumentView(origin=places.scenario, name=f"{name}: verdict"), active_tab=0)
