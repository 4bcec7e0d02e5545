"""How the Rerun view is laid out: the scene on the left, its numbers on the right."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import log10

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.drawing import TIMELINE
from cube_sim.recording.rerun.drawn import Drawn
from cube_sim.recording.rerun.guides import shown_error_m
from cube_sim.recording.rerun.places import Places
from cube_sim.recording.rerun.plots import (
    ATTITUDE,
    BATTERY,
    ERROR,
    FINS,
    FORCE,
    HEADING,
    HEALTH,
    HEIGHT,
    JOINTS,
    LANES,
    MOMENT,
    NAVIGATION,
    POWER,
    SETPOINTS,
    SURPRISE,
    THRUSTERS,
    VELOCITY,
    WATER,
    curves,
)

# From where the path is seen, in multiples of its radius: a little above, towards a corner of the x-y plane.
_EYE_DIRECTION = np.array([-0.95, -1.2, 0.6])
_SMALLEST_RADIUS = 1.5  # m
_CLOSE_UP = (-2.3, -2.65, 1.75)  # in multiples of the vehicle's extent, body axes
_HULLS_IN_SIGHT = 3.0  # so many times the vehicle's extent is in sight at least

CLOSE_ERROR_M = 0.12  # m, what the second plot of the path error shows either side of 0
_LEGEND = 0.3  # of the run's duration: free time after it, where the legends of the plots stand clear of the curves


def blueprint(drawn: Drawn) -> rrb.Blueprint:
    """Lay out the view of a run; views of channels it does not have are left out."""
    places, story = drawn.places, drawn.story
    names = {channel.name for channel in drawn.channels}
    left = rrb.Vertical(
        scene([drawn]),
        rrb.Horizontal(_close_up(drawn), _messages(drawn, names), column_shares=[4.0, 5.0]),
        row_shares=[0.85, 1.0],
    )
    rows = [row for row in _plots(Plots(story.duration_s, places), drawn, names) if row is not None]
    right = rrb.Vertical(*rows, row_shares=[1.0] * len(rows))
    return whole(rrb.Horizontal(left, right, column_shares=[5.0, 4.0]) if rows else left)


def whole(content: rrb.View | rrb.Container) -> rrb.Blueprint:
    """A layout of this content alone, on the simulated time."""
    return rrb.Blueprint(
        content,
        rrb.TimePanel(state="collapsed", timeline=TIMELINE),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def _messages(drawn: Drawn, names: Collection[str]) -> rrb.Container:
    """How the vehicle flies, what was said, and what the scenario asks for."""
    places, time = drawn.places, time_axis(drawn.story.duration_s)
    views: list[rrb.View] = []
    if "allocation" in names:
        views.append(rrb.StateTimelineView(origin=places.at(LANES), name="Allocation", time_view=time))
    if "health" in names:
        views.append(rrb.StateTimelineView(origin=places.at(HEALTH), name="Health", time_view=time))
    views.append(rrb.TextLogView(origin=places.log, name="Log"))
    views.append(rrb.TextDocumentView(origin=places.scenario, name="Verdict, scenario"))
    return rrb.Tabs(*views, active_tab=0)


def _plots(plot: Plots, drawn: Drawn, names: Collection[str]) -> Iterator[rrb.View | rrb.Container | None]:
    """Rows of plots, those that belong together behind one another."""
    if "path_error" in names:
        size = shown_error_m(drawn.story, CLOSE_ERROR_M)
        close = plot.close_up(ERROR, f"within {100 * size:.3g} cm", size)
        errors = rrb.Tabs(plot(ERROR, "Path error [m]"), plot(ATTITUDE, "Attitude error [rad]"), active_tab=0)
        yield rrb.Horizontal(errors, close)
    shown = {curve.entity for curve in curves(drawn.channels)}

    def tabs(*plots: tuple[str, str]) -> rrb.Container | None:
        views = [plot(place, name) for place, name in plots if any(entity.startswith(place) for entity in shown)]
        return rrb.Tabs(*views, active_tab=0) if views else None

    yield tabs(
        (NAVIGATION, "Navigation error [m]"),
        (SURPRISE, "Innovations squared / covariance [1]"),
        (VELOCITY, "Velocity [m/s]"),
        (HEIGHT, "Height [m]"),
        (HEADING, "Heading [deg]"),
    )
    yield tabs(
        (THRUSTERS, "Thruster forces [N]"),
        (FINS, "Fin deflections [deg]"),
        (SETPOINTS, "Set-points"),
        (JOINTS, "Joints"),
        (FORCE, "Force [N]"),
        (MOMENT, "Moment [N m]"),
        (WATER, "Current [m/s]"),
        (POWER, "Power [W]"),
        (BATTERY, "Charge [%] and voltage [V]"),
    )


def scene(runs: Sequence[Drawn], origin: str | None = None) -> rrb.Spatial3DView:
    """All that is to be seen of some runs, from where it is in sight; by default what is below the first's world."""
    points = np.vstack([drawn.points for drawn in runs])
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    centre = (low + high) / 2
    names = [name for name in (drawn.look.name or drawn.story.name for drawn in runs) if name]
    reach = max(drawn.extent for drawn in runs)
    radius = max(float(np.linalg.norm(high - low)) / 2, _SMALLEST_RADIUS, _HULLS_IN_SIGHT * reach)
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=centre + radius * _EYE_DIRECTION,
        look_target=centre,
        eye_up=(0.0, 0.0, 1.0),
    )
    start, end = rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative()
    trails = [entity for drawn in runs for entity in _trails(drawn)]
    return rrb.Spatial3DView(
        origin=runs[0].places.world if origin is None else origin,
        name=": ".join([*([" beside ".join(names)] if names else []), "vehicle, path and virtual target"]),
        background=rrb.Background(color=[*palette.WATER, 255]),
        line_grid=rrb.LineGrid3D(
            visible=True,
            spacing=_spacing(radius),
            plane=rr.components.Plane3D(normal=(0, 0, 1), distance=float(low[2]) - max(0.5, reach)),
            color=[*palette.GRID, 255],
            stroke_width=1.0,
        ),
        eye_controls=eye,
        # All of the trails up to now; everything else as it is now.
        overrides={trail: rrb.VisibleTimeRanges(timeline=TIMELINE, start=start, end=end) for trail in trails},
    )


def _trails(drawn: Drawn) -> list[str]:
    places, names = drawn.places, {channel.name for channel in drawn.channels}
    trails = [places.trail, *([places.estimate_trail] if "navigation" in names else [])]
    return [*trails, *([places.fixes] if "sensor_position" in names else [])]


def _spacing(radius: float) -> float:
    """Of the grid [m]: a power of ten, so that some ten lines are in sight."""
    return 10.0 ** max(0, round(log10(radius / 5)))


def _close_up(drawn: Drawn) -> rrb.Spatial3DView:
    """Ride with the vehicle: the view stands still in body axes, the path goes by.

    The hull is a wire frame here, so that the thrusters inside it are seen, and they carry their names.
    """
    places, reach = drawn.places, drawn.extent
    hidden = (
        f"{places.vehicle}/axes",
        places.trail,
        f"{places.target}/**",
        f"{places.estimate}/**",
        f"{places.surface}/**",
    )
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=tuple(reach * each for each in _CLOSE_UP),
        look_target=(0.0, 0.0, 0.2 * reach),
        eye_up=(0.0, 0.0, 1.0),
    )
    longest = drawn.measures.largest_N
    return rrb.Spatial3DView(
        origin=places.vehicle,
        contents=[f"+ {places.world}/**", *(f"- {entity}" for entity in hidden)],
        name=f"Thrust, up to {longest:.3g} N, and current",
        background=rrb.Background(color=[*palette.WATER, 255]),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=eye,
        overrides={
            **{body: rr.Boxes3D.from_fields(fill_mode=rr.components.FillMode.MajorWireframe) for body in drawn.boxes},
            places.thrusters: rr.Cylinders3D.from_fields(show_labels=True),
        },
    )


class Plots:
    """Makes plots over the whole run."""

    def __init__(self, duration_s: float | None, places: Places) -> None:
        self._duration_s, self._places = duration_s, places

    def __call__(self, plot: str, name: str) -> rrb.TimeSeriesView:
        """All curves of a plot."""
        return rrb.TimeSeriesView(
            origin=self._places.at(plot),
            name=name,
            axis_x=time_axis(self._duration_s, _LEGEND),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=True),
        )

    def of(
        self, name: str, entities: Sequence[str], colours: Mapping[str, rr.SeriesLines], size: float | None = None
    ) -> rrb.TimeSeriesView:
        """Some curves in colours of their own, from -size to size where that is given."""
        return rrb.TimeSeriesView(
            origin="/",
            contents=list(entities),
            name=name,
            axis_x=time_axis(self._duration_s, _LEGEND if size is None else 0.0),
            axis_y=None if size is None else rrb.ScalarAxis(range=(-size, size)),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=size is None),
            overrides={**colours},
        )

    def close_up(self, plot: str, name: str, size: float) -> rrb.TimeSeriesView:
        """The same curves from -size to size; their legend stands in the plot beside it."""
        return rrb.TimeSeriesView(
            origin=self._places.at(plot),
            name=name,
            axis_x=time_axis(self._duration_s),
            axis_y=rrb.ScalarAxis(range=(-size, size)),
            plot_legend=rrb.PlotLegend(visible=False),
        )


def time_axis(duration_s: float | None, beyond: float = 0.0) -> rrb.TimeAxis:
    """All of a run's time, and a share of it more after its end."""
    if duration_s is None:
        start = end = rrb.TimeRangeBoundary.infinite()
    else:
        start = rrb.TimeRangeBoundary.absolute(seconds=0.0)
        end = rrb.TimeRangeBoundary.absolute(seconds=(1.0 + beyond) * duration_s)
    return rrb.TimeAxis(view_range=rrb.TimeRange(start=start, end=end))
