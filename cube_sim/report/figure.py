"""A run as a figure for a publication: panels over time, and the path from above."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from warnings import catch_warnings, simplefilter

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.report import colours
from cube_sim.report.above_frame import LEGEND_EM, LEGEND_POINTS, Above, write_above
from cube_sim.report.figure_panels import TARGET, Plot, height_panel, panel_of, usual_panels
from cube_sim.report.happenings import EVENT, happenings
from cube_sim.report.subject import Subject
from cube_sim.scenario.check_blocks import SignalCheckBlock
from cube_sim.scenario.statistic_keys import AMONG_SAMPLES, statistic_alone
from cube_sim.scenario.windows import window_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")
WIDTH_MM, ROW_MM = 170.0, 42.0
"""Two columns of a usual journal; height of a panel."""
BESIDE_MM, _LEAST_FRAME_MM = 120.0, 15.0
"""From which width on the path is beside the curves over time instead of above them; the least width of a frame."""

_MM_PER_INCH = 25.4
_NOISE = 2e-5
"""The axis spans so large a share of its numbers at least, or rounding would be seen as motion (choice)."""
_NOT_RECORDED = "#eceae4"
_SIGNS = {"<=": "≤", ">=": "≥"}
_STYLE: dict[Any, Any] = {
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "legend.fontsize": LEGEND_POINTS,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "lines.linewidth": 1.0,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.color": "#dde1e6",
    "legend.frameon": False,
    **LEGEND_EM,
    "legend.borderpad": 0.0,
    "legend.borderaxespad": 0.0,
    "savefig.dpi": 300,
    "svg.hashsalt": "cube_sim",
    "figure.constrained_layout.use": True,
}
_NO_DATES: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
"""The same run gives the same bytes."""


def save_figure(
    subject: Subject,
    signals: Sequence[str],
    file: Path,
    width_mm: float = WIDTH_MM,
    window_s: tuple[float, float] | None = None,
) -> None:
    """Draw a run and write it.

    Args:
        subject: the run.
        signals: what is drawn, a panel each, as channel.field or channel.field.column; none for the path, the errors
            and the forces.
        file: where it goes; its suffix is one of `FORMATS`.
        width_mm: of the figure.
        window_s: from when to when [s]; None for the whole run.

    Raises:
        RecordingError: no such signal, nothing to draw of it, or too little room for what is written.
        OSError: the file cannot be written.
    """
    panels = [panel_of(subject, signal) for signal in signals] or usual_panels(subject)
    if not any(len(rows) for panel in panels for _, rows in panel.curves):
        raise RecordingError(f"{subject.run.path}: there are no rows to draw")
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        mapped = not signals and subject.has("pose.position")
        beside = mapped and width_mm >= BESIDE_MM
        rows = len(panels)
        tall = ROW_MM * (rows + (mapped and not beside)) + (width_mm if mapped and not beside else 0.0)
        figure = Figure(figsize=(width_mm / _MM_PER_INCH, (8.0 + tall) / _MM_PER_INCH))
        if beside:
            grid = figure.add_gridspec(rows, 2, width_ratios=[1.0, 1.35])
            above = [
                _plan(figure.add_subplot(grid[: max(rows - 1, 1), 0]), subject, window_s),
                _over_time(figure.add_subplot(grid[rows - 1, 0]), height_panel(subject), subject, window_s),
            ]
            places = [grid[row, 1] for row in range(rows)]
        elif mapped:
            grid = figure.add_gridspec(rows + 2, 1, height_ratios=[width_mm, *[ROW_MM] * (rows + 1)])
            above = [_plan(figure.add_subplot(grid[0, 0]), subject, window_s)]
            panels = [height_panel(subject), *panels]
            places = [grid[row, 0] for row in range(1, rows + 2)]
        else:
            grid, above = figure.add_gridspec(rows, 1), []
            places = [grid[row, 0] for row in range(rows)]
        above += _stack(figure, places, panels, subject, window_s)
        with catch_warnings():
            simplefilter("ignore", UserWarning)  # of frames that collapse: they are looked at below
            write_above(figure, above)
            figure.draw_without_rendering()
            _require_room(figure, width_mm)
            suffix = file.suffix.lower()
            # Not to the file: each format has words of its own for a disk that is full.
            drawn = BytesIO()
            figure.savefig(drawn, format=suffix[1:], metadata=_NO_DATES[suffix])
    file.write_bytes(drawn.getbuffer())


def _require_room(figure: Figure, width_mm: float) -> None:
    """Make sure that a figure that has been laid out shows its curves, and that nothing written is cut off.

    Raises:
        RecordingError: it does not.
    """
    mm = _MM_PER_INCH / figure.dpi
    for axes in figure.axes:
        legend = axes.get_legend()
        ends = 0.0 if legend is None else legend.get_window_extent().x1 * mm
        if axes.bbox.width * mm < _LEAST_FRAME_MM or ends > width_mm + 0.5:
            raise RecordingError(f"--width-mm {width_mm:g}: too narrow for what is written beside the curves")


def _stack(
    figure: Figure, places: Sequence, panels: Sequence[Plot], subject: Subject, window_s: tuple[float, float] | None
) -> list[Above]:
    """Panels above one another on one time."""
    first: Axes | None = None
    above = []
    for number, (place, panel) in enumerate(zip(places, panels, strict=True)):
        axes = figure.add_subplot(place, sharex=first)
        first = first or axes
        last = number == len(panels) - 1
        above.append(_over_time(axes, panel, subject, window_s, told=number == 0, timed=last))
    return above


def _over_time(
    axes: Axes,
    panel: Plot,
    subject: Subject,
    window_s: tuple[float, float] | None,
    told: bool = False,
    timed: bool = True,
) -> Above:
    """Curves, limits of checks, events; what the scenario lets happen is named where it is to be told."""
    start, end = window_s or (0.0, subject.run.recorded_s)
    own = [name for name, _ in panel.curves if name != TARGET]
    for name, rows in panel.curves:
        asked = name == TARGET
        shown = rows[(rows[:, 0] >= start) & (rows[:, 0] <= end)]
        colour = colours.FAINT if asked else colours.of_index(own.index(name))
        line = "--" if asked else colours.dash_of_index(own.index(name))
        drawn = "steps-post" if panel.states else "default"
        axes.plot(shown[:, 0], shown[:, 1], color=colour, linestyle=line, drawstyle=drawn, label=name)
    axes.set_xlim(start, max(end, start + 1e-9))
    unit = [panel.unit] if panel.unit not in ("", "1") else []
    for check in _limits(subject, panel):
        begins, ends = subject.span(window_of(check, subject.scenario.events))
        begins, ends = max(start, begins), min(end, ends)
        label = " ".join([statistic_alone(check), _SIGNS[check.bound.relation], f"{check.bound.limit:g}", *unit])
        limit = [check.bound.limit] * 2
        axes.plot([begins, ends], limit, color=colours.BAD, linestyle=(0, (5, 2)), linewidth=0.9, label=label)
    for begins, ends in [(each.start_s, each.end_s) for each in subject.phases[1::2]]:
        begins, ends = max(start, begins), min(end, ends)
        if begins < ends:
            axes.axvspan(begins, ends, color=colours.EVERY_SECOND, linewidth=0, zorder=0.4)
    for begins, ends in subject.gaps:
        axes.axvspan(begins, ends, color=_NOT_RECORDED, linewidth=0, zorder=0.5)
    happened = [each for each in happenings(subject) if start <= each.t <= end]
    for each in happened:
        colour = colours.BAD if each.kind == EVENT else colours.FAINT
        axes.axvline(each.t, color=colour, linewidth=0.7, linestyle=":", zorder=1)
    axes.set_ylabel(panel.label)
    axes.ticklabel_format(axis="y", useOffset=False)
    low, high = axes.get_ylim()
    short = max(panel.least, _NOISE * max(abs(low), abs(high))) - (high - low)
    if short > 0:
        axes.set_ylim(low - short / 2, high + short / 2)
    if timed:
        axes.set_xlabel("time [s]")
    else:
        axes.tick_params(labelbottom=False)
    if panel.states:
        _name_states(axes, panel.states)
    named = tuple(each for each in happened if told and each.kind == EVENT)
    return Above(axes, named, curves=len(axes.get_legend_handles_labels()[1]) > 1)


def _name_states(axes: Axes, states: Sequence[str]) -> None:
    """Names in place of numbers, of the states of a code from the first to the last that is drawn."""
    low, high = axes.dataLim.intervaly
    numbers = range(max(0, round(low)), min(len(states) - 1, round(high)) + 1)
    axes.set_yticks([*numbers], [states[k] for k in numbers])


def _plan(axes: Axes, subject: Subject, window_s: tuple[float, float] | None) -> Above:
    """The path and the track from above."""
    path = subject.rows("path.points")
    if len(path):
        x, y = path[0, 1:].reshape(-1, 3)[:, :2].T
        axes.plot(x, y, color=colours.FAINT, linestyle="--", linewidth=0.9, label="path")
    position = subject.rows("pose.position")
    start, end = window_s or (-np.inf, np.inf)
    shown = position[(position[:, 0] >= start) & (position[:, 0] <= end)]
    axes.plot(shown[:, 1], shown[:, 2], color=colours.BLUE, label="vehicle")
    if len(shown):
        axes.plot(*shown[0, 1:3], marker="o", markersize=3.5, color=colours.BLACK, linestyle="", label="start")
    for each in happenings(subject):
        if each.kind == EVENT and len(shown) and shown[0, 0] <= each.t <= shown[-1, 0]:
            at = shown[np.searchsorted(shown[:, 0], each.t)]
            axes.plot(at[1], at[2], marker="x", markersize=5, color=colours.BAD, linestyle="")
            axes.annotate(
                f"{each.t:g} s", (at[1], at[2]), (4, 3), textcoords="offset points", color=colours.BAD, fontsize=6.5
            )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x, east [m]")
    axes.set_ylabel("y, north [m]")
    return Above(axes, (), curves=True)


def _limits(subject: Subject, panel: Plot) -> Iterator[SignalCheckBlock]:
    """Checks whose limit is one on what is drawn: on a number, not on the norm of several that are drawn apart."""
    name, _, part = panel.signal.rpartition(".")
    for check in subject.scenario.checks:
        if not isinstance(check, SignalCheckBlock) or check.statistic not in AMONG_SAMPLES or check.minus:
            continue
        if check.signal == panel.signal:
            field = subject.run.fields[panel.signal]
            if check.component is not None or field.width == 1:
                yield check
        elif check.signal == name and check.component is not None:
            columns = subject.columns(name)
            if columns.index(part) == check.component:
                yield check
