"""A run as a figure for a publication: panels over time, and the path from above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.report import colours
from cube_sim.report.happenings import EVENT, Happening, happenings
from cube_sim.report.subject import Subject
from cube_sim.scenario.check_blocks import SignalCheckBlock

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = (".png", ".svg", ".pdf")
WIDTH_MM, ROW_MM = 170.0, 42.0
"""Two columns of a usual journal; height of a panel."""

_MM_PER_INCH = 25.4
_NOISE = 2e-5
"""The axis spans so large a share of its numbers at least, or rounding would be seen as motion (choice)."""
_NAME_POINTS, _NAME_EM, _POINTS_PER_INCH = 6.5, 0.55, 72.0
"""Size of an event's name, and how wide its letters are at most on average, in sizes."""
_TARGET = "target"
_NOT_RECORDED = "#eceae4"
_LEGEND_COLUMNS = 3
_SIGNS = {"<=": "≤", ">=": "≥"}
_STYLE: dict[Any, Any] = {
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "legend.fontsize": 7.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "lines.linewidth": 1.0,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.color": "#dde1e6",
    "legend.frameon": False,
    "legend.handlelength": 1.4,
    "legend.columnspacing": 1.0,
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


@dataclass(frozen=True)
class Plot:
    """Curves over time in one frame.

    Attributes:
        label: of the upright axis, with its unit.
        curves: a name for each and its rows (n, 2), time [s] and number.
        signal: what is drawn, for the limits of checks on it; "" where no check can be.
        unit: of the limits.
        least: the axis spans so much at least, in that unit: below it there is nothing to see but noise.
    """

    label: str
    curves: tuple[tuple[str, Rows], ...]
    signal: str = ""
    unit: str = ""
    least: float = 0.0


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
        RecordingError: no such signal, or nothing to draw of it.
        OSError: the file cannot be written.
    """
    panels = [_of_signal(subject, signal) for signal in signals] or _usual(subject)
    if not any(len(rows) for panel in panels for _, rows in panel.curves):
        raise RecordingError(f"{subject.run.path}: there are no rows to draw")
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        usual = not signals
        rows = len(panels)
        figure = Figure(figsize=(width_mm / _MM_PER_INCH, (8.0 + ROW_MM * rows) / _MM_PER_INCH))
        if usual and subject.has("pose.position"):
            grid = figure.add_gridspec(rows, 2, width_ratios=[1.0, 1.35])
            _plan(figure.add_subplot(grid[: max(rows - 1, 1), 0]), subject, window_s)
            _over_time(figure, figure.add_subplot(grid[rows - 1, 0]), _height(subject), subject, window_s)
            places = [grid[row, 1] for row in range(rows)]
        else:
            grid = figure.add_gridspec(rows, 1)
            places = [grid[row, 0] for row in range(rows)]
        _stack(figure, places, panels, subject, window_s)
        suffix = file.suffix.lower()
        figure.savefig(file, format=suffix[1:], metadata=_NO_DATES[suffix])


def _stack(
    figure: Figure, places: Sequence, panels: Sequence[Plot], subject: Subject, window_s: tuple[float, float] | None
) -> None:
    """Panels above one another on one time."""
    first: Axes | None = None
    for number, (place, panel) in enumerate(zip(places, panels, strict=True)):
        axes = figure.add_subplot(place, sharex=first)
        first = first or axes
        last = number == len(panels) - 1
        _over_time(figure, axes, panel, subject, window_s, told=number == 0, timed=last)


def _over_time(
    figure: Figure,
    axes: Axes,
    panel: Plot,
    subject: Subject,
    window_s: tuple[float, float] | None,
    told: bool = False,
    timed: bool = True,
) -> None:
    """Curves, limits of checks, events."""
    start, end = window_s or (0.0, subject.run.recorded_s)
    own = [name for name, _ in panel.curves if name != _TARGET]
    for name, rows in panel.curves:
        asked = name == _TARGET
        shown = rows[(rows[:, 0] >= start) & (rows[:, 0] <= end)]
        colour = colours.FAINT if asked else colours.of_index(own.index(name))
        axes.plot(shown[:, 0], shown[:, 1], color=colour, linestyle="--" if asked else "-", label=name)
    axes.set_xlim(start, max(end, start + 1e-9))
    unit = [panel.unit] if panel.unit not in ("", "1") else []
    for check in subject.scenario.checks:
        if isinstance(check, SignalCheckBlock) and panel.signal and _judges(check, panel.signal):
            begins = max(start, check.from_s or 0.0)
            ends = min(end, subject.scenario.duration_s if check.to_s is None else check.to_s)
            label = " ".join([check.statistic, _SIGNS[check.bound.relation], f"{check.bound.limit:g}", *unit])
            limit = [check.bound.limit] * 2
            axes.plot([begins, ends], limit, color=colours.BAD, linestyle=(0, (5, 2)), linewidth=0.9, label=label)
    for begins, ends in subject.gaps:
        axes.axvspan(begins, ends, color=_NOT_RECORDED, linewidth=0, zorder=0.5)
    _mark(figure, axes, [each for each in happenings(subject) if start <= each.t <= end], told)
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
    handles, labels = axes.get_legend_handles_labels()
    if len(labels) > 1 or (labels and labels != [panel.label.partition(" [")[0]]):
        axes.legend(handles, labels, ncols=min(len(labels), _LEGEND_COLUMNS), loc="best")


def _mark(figure: Figure, axes: Axes, told: Sequence[Happening], named: bool) -> None:
    """Upright lines where something happened; what the scenario lets happen is named above the topmost panel."""
    for each in told:
        colour = colours.BAD if each.kind == EVENT else colours.FAINT
        axes.axvline(each.t, color=colour, linewidth=0.7, linestyle=":", zorder=1)
    if named:
        _name(figure, axes, [each for each in told if each.kind == EVENT])


def _name(figure: Figure, axes: Axes, events: Sequence[Happening]) -> None:
    """Names of events beside their lines: within the frame's width, and above one another where they would meet."""
    start, end = axes.get_xlim()
    points = axes.bbox.width * _POINTS_PER_INCH / figure.dpi
    taken: list[list[tuple[float, float]]] = []
    for each in events:
        wide = _NAME_EM * _NAME_POINTS * len(each.text) * (end - start) / points
        leftwards = each.t + wide > end and each.t - wide >= start
        low, high = (each.t - wide, each.t) if leftwards else (each.t, each.t + wide)
        row = next((k for k, spans in enumerate(taken) if all(high <= a or b <= low for a, b in spans)), len(taken))
        taken += [[]] * (row == len(taken))
        taken[row] = [*taken[row], (low, high)]
        axes.annotate(
            each.text,
            (each.t, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(-2 if leftwards else 2, 2 + row * 1.2 * _NAME_POINTS),
            textcoords="offset points",
            ha="right" if leftwards else "left",
            color=colours.BAD,
            fontsize=_NAME_POINTS,
            annotation_clip=False,
        )


def _plan(axes: Axes, subject: Subject, window_s: tuple[float, float] | None) -> None:
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
    axes.legend(loc="best")


def _usual(subject: Subject) -> list[Plot]:
    """Errors, force, thrusters: of what is recorded."""
    made = (
        Plot(
            "path error [m]",
            tuple(
                (name, _column(subject, f"path_error.{field}", 0))
                for name, field in (("cross-track", "cross_track"), ("along-track", "along"))
            ),
            "path_error.cross_track",
            "m",
            0.01,
        ),
        Plot(
            "force demanded [N]",
            tuple((name, _column(subject, "wrench.demanded", i)) for i, name in enumerate(("Fx", "Fy", "Fz"))),
        ),
        _whole(subject, "thrusters.force"),
    )
    return [panel for panel in made if any(len(rows) for _, rows in panel.curves)]


def _height(subject: Subject) -> Plot:
    target = _column(subject, "target.position", 2)
    curves = [(_TARGET, target)] if len(target) else []
    return Plot("height z [m]", (*curves, ("vehicle", _column(subject, "pose.position", 2))), least=0.1)


def _of_signal(subject: Subject, name: str) -> Plot:
    """A panel of channel.field, or of one of its columns."""
    if name in subject.run.fields:
        panel = _whole(subject, name)
    else:
        signal, _, part = name.rpartition(".")
        columns = subject.columns(signal)
        own = [each for each in subject.run.fields if each.startswith(f"{name}.")]
        if own:
            raise RecordingError(f"{name} is a channel; its signals are {', '.join(own)}")
        if signal not in subject.run.fields or part not in columns:
            raise RecordingError(f"no signal {name!r}{_hint(subject, name)}")
        index = columns.index(part)
        full = subject.run.column_names(signal)[index]
        unit = subject.run.fields[signal].units[index]
        label = full.partition(" [")[0]
        panel = Plot(_labelled(label, unit), ((label, _column(subject, signal, index)),), name, unit)
    if not any(len(rows) for _, rows in panel.curves):
        raise RecordingError(f"{name}: is declared, but nothing was recorded of it")
    return panel


def _whole(subject: Subject, signal: str) -> Plot:
    columns = subject.columns(signal)
    field = subject.run.fields.get(signal)
    if field is None:
        return Plot(signal, ())
    names = (signal,) if field.is_single_number else columns
    curves = tuple((name, _column(subject, signal, index)) for index, name in enumerate(names))
    return Plot(_labelled(signal.replace("_", " ").replace(".", " "), field.unit), curves, signal, field.unit)


def _labelled(name: str, unit: str) -> str:
    return name if unit == "1" else f"{name} [{unit}]"


def _column(subject: Subject, signal: str, index: int) -> Rows:
    rows = subject.rows(signal)
    return rows[:, [0, 1 + index]] if index + 1 < rows.shape[1] else np.empty((0, 2))


def _judges(check: SignalCheckBlock, signal: str) -> bool:
    """Whether a check's limit is one on what is drawn: on a number, not on the norm of several that are drawn apart."""
    name, _, part = signal.rpartition(".")
    return check.signal == signal or (check.signal == name and part == str(check.component))


def _hint(subject: Subject, name: str) -> str:
    known = [*subject.run.fields]
    known += [f"{signal}.{column}" for signal in known for column in subject.columns(signal)]
    near = get_close_matches(name, known, 1)
    return f"; did you mean {near[0]}?" if near else "; `cube-sim signals SCENARIO` lists them"
