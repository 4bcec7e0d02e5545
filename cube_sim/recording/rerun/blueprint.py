"""How the Rerun view is laid out: the scene on the left, its numbers on the right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from cube_sim.recording.channels import Channel
from cube_sim.recording.rerun import palette
from cube_sim.recording.rerun.plots import (
    ATTITUDE,
    ERROR,
    FORCE,
    HEALTH,
    LANES,
    MOMENT,
    NAVIGATION,
    POWER,
    THRUSTERS,
    WATER,
)
from cube_sim.recording.rerun.scene import ESTIMATE, ESTIMATE_TRAIL, LOG, TARGET, TRAIL, VEHICLE, WORLD

TIMELINE = "sim_time"

# From where the path is seen, in multiples of its radius: a little above, towards a corner of the x-y plane.
_EYE_DIRECTION = np.array([-0.95, -1.2, 0.6])
_SMALLEST_RADIUS = 1.5  # m
_CLOSE_UP = (-1.0, -1.15, 0.75)  # m, in body axes

_CLOSE_ERROR = 0.12  # m, what the second plot of the path error shows either side of 0
_LEGEND = 0.3  # of the run's duration: free time after it, where the legends of the plots stand clear of the curves


def blueprint(
    channels: Sequence[Channel],
    points: NDArray[np.float64],
    boxes: Sequence[str] = (),
    duration_s: float | None = None,
) -> rrb.Blueprint:
    """Lay out the view of a run.

    Args:
        channels: the channel table; views of channels it does not have are left out.
        points: (n, 3) what must be in sight in world axes [m]; n may be 0.
        boxes: Rerun paths of the boxes the vehicle is made of.
        duration_s: how long the run is meant to last [s]; None when nobody knows.
    """
    plot = _Plots(duration_s)
    names = {channel.name for channel in channels}
    estimated = "navigation" in names
    scene = _scene(points, (TRAIL, ESTIMATE_TRAIL) if estimated else (TRAIL,))
    close_up = _close_up(boxes, (TRAIL, f"{TARGET}/**", f"{ESTIMATE}/**") if estimated else (TRAIL, f"{TARGET}/**"))
    lanes = rrb.StateTimelineView(origin=LANES, name="Allocation", time_view=_time(duration_s))
    health = rrb.StateTimelineView(origin=HEALTH, name="Health", time_view=_time(duration_s))
    plots: list[tuple[float, rrb.View | rrb.Container]] = []
    if "path_error" in names:
        whole, close = plot(ERROR, "Path error [m]"), plot.close_up(ERROR, "within 12 cm", _CLOSE_ERROR)
        plots.append((3.0, rrb.Horizontal(whole, close)))
    if "navigation_error" in names:
        plots.append((2.4, plot(NAVIGATION, "Navigation error and its standard deviation [m]")))
    if "wrench" in names:
        force = plot(FORCE, "Force [N]")
        moment = plot(MOMENT, "Moment [N m]")
        attitude = plot(ATTITUDE, "Attitude error [rad]")
        tabs = [force, moment, attitude, *([plot(WATER, "Current [m/s]")] if "water" in names else [])]
        plots.append((3.0, rrb.Tabs(*tabs, active_tab=0)))
    if "thrusters" in names:
        drawn = [plot(POWER, "Power [W] and voltage [V]")] if "power" in names else []
        plots.append((3.6, rrb.Tabs(plot(THRUSTERS, "Thruster forces [N]"), *drawn, active_tab=0)))
    log = rrb.TextLogView(origin=LOG, name="Log")
    tabs = [view for name, view in (("allocation", lanes), ("health", health)) if name in names]
    messages = rrb.Tabs(*tabs, log, active_tab=0)
    below = rrb.Horizontal(close_up, messages, column_shares=[4.0, 5.0])
    left = rrb.Vertical(scene, below, row_shares=[0.85, 1.0])
    right = rrb.Vertical(*(view for _, view in plots), row_shares=[share for share, _ in plots])
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[5.0, 4.0]) if plots else left,
        rrb.TimePanel(state="collapsed", timeline=TIMELINE),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def _scene(points: NDArray[np.float64], trails: Sequence[str]) -> rrb.Spatial3DView:
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    centre = (low + high) / 2
    radius = max(float(np.linalg.norm(high - low)) / 2, _SMALLEST_RADIUS)
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=centre + radius * _EYE_DIRECTION,
        look_target=centre,
        eye_up=(0.0, 0.0, 1.0),
    )
    start, end = rrb.TimeRangeBoundary.infinite(), rrb.TimeRangeBoundary.cursor_relative()
    return rrb.Spatial3DView(
        origin=WORLD,
        name="Vehicle, path and virtual target",
        background=rrb.Background(color=[*palette.WATER, 255]),
        line_grid=rrb.LineGrid3D(
            visible=True,
            spacing=1.0,
            plane=rr.components.Plane3D(normal=(0, 0, 1), distance=float(low[2]) - 0.5),
            color=[*palette.GRID, 255],
            stroke_width=1.0,
        ),
        eye_controls=eye,
        # All of the trails up to now; everything else as it is now.
        overrides={trail: rrb.VisibleTimeRanges(timeline=TIMELINE, start=start, end=end) for trail in trails},
    )


def _close_up(bodies: Sequence[str], hidden: Sequence[str]) -> rrb.Spatial3DView:
    """Ride with the vehicle: the view stands still in body axes, the path goes by.

    The hull is a wire frame here, so that the thrusters inside it are seen, and they carry their names.
    """
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=_CLOSE_UP, look_target=(0.0, 0.0, 0.1), eye_up=(0.0, 0.0, 1.0)
    )
    return rrb.Spatial3DView(
        origin=VEHICLE,
        contents=[f"+ {WORLD}/**", *(f"- {entity}" for entity in (f"{VEHICLE}/axes", *hidden))],
        name="Thrust and current, seen from the vehicle",
        background=rrb.Background(color=[*palette.WATER, 255]),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=eye,
        overrides={
            **{body: rr.Boxes3D.from_fields(fill_mode=rr.components.FillMode.MajorWireframe) for body in bodies},
            f"{VEHICLE}/thrusters": rr.Cylinders3D.from_fields(show_labels=True),
        },
    )


class _Plots:
    """Makes plots over the whole run."""

    def __init__(self, duration_s: float | None) -> None:
        self._duration_s = duration_s

    def __call__(self, origin: str, name: str) -> rrb.TimeSeriesView:
        return rrb.TimeSeriesView(
            origin=origin,
            name=name,
            axis_x=_time(self._duration_s, _LEGEND),
            plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=True),
        )

    def close_up(self, origin: str, name: str, size: float) -> rrb.TimeSeriesView:
        """The same curves from -size to size; their legend stands in the plot beside it."""
        return rrb.TimeSeriesView(
            origin=origin,
            name=name,
            axis_x=_time(self._duration_s),
            axis_y=rrb.ScalarAxis(range=(-size, size)),
            plot_legend=rrb.PlotLegend(visible=False),
        )


def _time(duration_s: float | None, beyond: float = 0.0) -> rrb.TimeAxis:
    """All of a run's time, and a share of it more after its end."""
    if duration_s is None:
        start = end = rrb.TimeRangeBoundary.infinite()
    else:
        start = rrb.TimeRangeBoundary.absolute(seconds=0.0)
        end = rrb.TimeRangeBoundary.absolute(seconds=(1.0 + beyond) * duration_s)
    return rrb.TimeAxis(view_range=rrb.TimeRange(start=start, end=end))
