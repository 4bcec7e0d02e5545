"""What a figure shows: curves over time, of the signals that are asked for or of the usual ones."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.report.colours import MOST_CURVES
from cube_sim.report.subject import Subject

TARGET = "target"
"""The curve that the vehicle should follow."""


@dataclass(frozen=True)
class Plot:
    """Curves over time in one frame.

    Attributes:
        label: of the upright axis, with its unit.
        curves: a name for each and its rows (n, 2), time [s] and number.
        signal: what is drawn, for the limits of checks on it; "" where no check can be.
        unit: of the limits.
        states: what the numbers 0, 1, 2 ... mean where they are a code, or ().
        least: the axis spans so much at least, in that unit: below it there is nothing to see but noise.
    """

    label: str
    curves: tuple[tuple[str, Rows], ...]
    signal: str = ""
    unit: str = ""
    states: tuple[str, ...] = ()
    least: float = 0.0


def usual_panels(subject: Subject) -> list[Plot]:
    """Errors, force, thrusters: of what a run recorded."""
    made = (
        Plot(
            "path error [m]",
            tuple(
                (name, _column(subject, f"path_error.{field}", 0))
                for name, field in (("cross-track", "cross_track"), ("along-track", "along"))
            ),
            "path_error.cross_track",
            "m",
            least=0.01,
        ),
        Plot(
            "force demanded [N]",
            tuple((name, _column(subject, "wrench.demanded", i)) for i, name in enumerate(("Fx", "Fy", "Fz"))),
        ),
        _whole(subject, "thrusters.force"),
    )
    return [panel for panel in made if any(len(rows) for _, rows in panel.curves)]


def height_panel(subject: Subject) -> Plot:
    """The vehicle's height, and that of its target where there is one."""
    target = _column(subject, "target.position", 2)
    curves = [(TARGET, target)] if len(target) else []
    return Plot("height z [m]", (*curves, ("vehicle", _column(subject, "pose.position", 2))), least=0.1)


def panel_of(subject: Subject, name: str) -> Plot:
    """A panel of a signal.

    Args:
        subject: the run.
        name: channel.field, or channel.field.column.

    Raises:
        RecordingError: no such signal, more columns than are told apart, or nothing was recorded of it.
    """
    if name in subject.run.fields:
        if (count := subject.run.fields[name].width) > MOST_CURVES:
            raise RecordingError(
                f"{name} has {count} columns, {MOST_CURVES} at most are told apart in one panel; name one of them: "
                f"{name}.{subject.columns(name)[0]}"
            )
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
    label = _labelled(signal.replace("_", " ").replace(".", " "), field.unit)
    return Plot(label, curves, signal, field.unit, field.labels)


def _labelled(name: str, unit: str) -> str:
    return name if unit == "1" else f"{name} [{unit}]"


def _column(subject: Subject, signal: str, index: int) -> Rows:
    rows = subject.rows(signal)
    return rows[:, [0, 1 + index]] if index + 1 < rows.shape[1] else np.empty((0, 2))


def _hint(subject: Subject, name: str) -> str:
    known = [*subject.run.fields]
    known += [f"{signal}.{column}" for signal in known for column in subject.columns(signal)]
    near = get_close_matches(name, known, 1)
    return f"; did you mean {near[0]}?" if near else "; `cube-sim signals SCENARIO` lists them"
