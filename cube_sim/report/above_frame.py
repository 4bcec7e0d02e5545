"""What stands above a frame of a figure: names of events, and above them those of the curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from cube_sim.report import colours
from cube_sim.report.happenings import Happening

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NAME_POINTS, LEGEND_POINTS = 6.5, 7.0
"""Sizes of an event's name and of a curve's."""
LEGEND_EM = {"legend.handlelength": 1.2, "legend.handletextpad": 0.5, "legend.columnspacing": 0.9}
"""What is around a curve's name, in sizes."""

_NAME_EM, _LINE, _POINTS_PER_INCH = 0.55, 1.2, 72.0
"""How wide letters are at most on average, and from one line to the next, in sizes."""


class Above(NamedTuple):
    """What is to be written above a frame, once its width is known.

    Attributes:
        axes: the frame.
        events: that are named.
        curves: whether its curves are.
    """

    axes: Axes
    events: tuple[Happening, ...]
    curves: bool


def write_above(figure: Figure, frames: Sequence[Above]) -> None:
    """Write above every frame of a figure that is else complete."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)  # the frames get the width that what is written beside them leaves
    for axes, events, curves in frames:
        lines = write_names(figure, axes, events)
        if curves:
            write_legend(figure, axes, lines)


def write_names(figure: Figure, axes: Axes, events: Sequence[Happening]) -> int:
    """Names of events beside their lines: within the frame's width, and above one another where they would meet.

    Returns:
        How many are above one another.
    """
    start, end = axes.get_xlim()
    points = axes.bbox.width * _POINTS_PER_INCH / figure.dpi
    taken: list[list[tuple[float, float]]] = []
    for each in events:
        wide = _NAME_EM * NAME_POINTS * len(each.text) * (end - start) / points
        leftwards = each.t + wide > end and each.t - wide >= start
        low, high = (each.t - wide, each.t) if leftwards else (each.t, each.t + wide)
        row = next((k for k, spans in enumerate(taken) if all(high <= a or b <= low for a, b in spans)), len(taken))
        taken += [[]] * (row == len(taken))
        taken[row] = [*taken[row], (low, high)]
        axes.annotate(
            each.text,
            (each.t, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(-2 if leftwards else 2, 2 + row * _LINE * NAME_POINTS),
            textcoords="offset points",
            ha="right" if leftwards else "left",
            color=colours.BAD,
            fontsize=NAME_POINTS,
            annotation_clip=False,
        )
    return len(taken)


def write_legend(figure: Figure, axes: Axes, lines: int = 0) -> None:
    """Names of curves above the frame, where they hide nothing, in as few lines as its width allows.

    Args:
        figure: the figure.
        axes: the frame.
        lines: of names of events between the frame and these.
    """
    from matplotlib.transforms import ScaledTranslation

    handles, labels = axes.get_legend_handles_labels()
    entry = LEGEND_POINTS * (sum(LEGEND_EM.values()) + _NAME_EM * max(map(len, labels)))
    most = max(1, int(axes.bbox.width * _POINTS_PER_INCH / figure.dpi / entry))
    columns = -(-len(labels) // -(-len(labels) // most))  # lines of one length
    raised = (3.0 + lines * _LINE * NAME_POINTS) / _POINTS_PER_INCH
    place = axes.transAxes + ScaledTranslation(0.0, raised, figure.dpi_scale_trans)
    axes.legend(handles, labels, ncols=columns, loc="lower left", bbox_to_anchor=(0.0, 1.0), bbox_transform=place)
