"""How the Rerun view is laid out: the scene on the left, its numbers on the right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from cube_sim.recording import palette
from cube_sim.recording.channels import Channel
from cube_sim.recording.rerun_plots import ATTITUDE, ERROR, FORCE, LANES, MOMENT, THRUSTERS
from cube_sim.recording.rerun_scene import TRAIL, WORLD

TIMELINE = "sim_time"

# From where the path is seen, in multiples of its radius: a little above, towards a corner of the x-y plane.
_EYE_DIRECTION = np.array([-1.45, -1.75, 0.95])
_SMALLEST_RADIUS = 1.5  # m


def blueprint(channels: Sequence[Channel], points: NDArray[np.float64]) -> rrb.Blueprint:
    """Lay out the view of a run.

    Args:
        channels: the channel table; views of channels it does not have are left out.
        points: (n, 3) what must be in sight in world axes [m]; n may be 0.
    """
    names = {channel.name for channel in channels}
    left: list[rrb.View] = [_scene(points)]
    if "allocation" in names:
        left.append(rrb.StateTimelineView(origin=LANES, name="Side of the dead zone, and the allocation"))
    right: list[rrb.View] = []
    if "path_error" in names:
        right += [_plot(ERROR, "Path error [m]"), _plot(ATTITUDE, "Attitude error [rad]")]
    if "wrench" in names:
        right += [
            _plot(FORCE, "Force: demanded, allocated [N]"),
            _plot(MOMENT, "Moment: demanded, allocated [N m]"),
        ]
    if "thrusters" in names:
        right.append(_plot(THRUSTERS, "Thruster forces [N]"))
    layout = rrb.Horizontal(
        rrb.Vertical(*left, row_shares=[3.0, 1.0][: len(left)]),
        rrb.Vertical(*right),
        column_shares=[3.0, 2.0],
    )
    return rrb.Blueprint(
        layout if right else left[0],
        rrb.TimePanel(state="collapsed", timeline=TIMELINE),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def _scene(points: NDArray[np.float64]) -> rrb.Spatial3DView:
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    centre = (low + high) / 2
    radius = max(float(np.linalg.norm(high - low)) / 2, _SMALLEST_RADIUS)
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
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=centre + radius * _EYE_DIRECTION,
            look_target=centre,
            eye_up=(0.0, 0.0, 1.0),
        ),
        # All of the trail up to now; everything else as it is now.
        overrides={TRAIL: rrb.VisibleTimeRanges(timeline=TIMELINE, start=start, end=end)},
    )


def _plot(origin: str, name: str) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=origin, name=name, plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.RightTop, visible=True)
    )
