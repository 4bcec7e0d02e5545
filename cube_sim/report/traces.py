"""Plots of several numbers of one or several runs.

Of one run the numbers of a vector share a plot, a colour each; of several runs each number has a plot, and each run its
colour.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.report import colours
from cube_sim.report.panel import Curve, Panel, Style
from cube_sim.report.subject import Subject


@dataclass(frozen=True)
class Trace:
    """One number over time.

    Attributes:
        component: which of the panel's: what has its own colour.
        role: what it is beside others of the same component, as in "desired"; "" where it stands alone.
        rows: of a run, (n, 2) time [s] and number.
        style: how it is drawn.
    """

    component: str
    role: str
    rows: Callable[[Subject], Rows]
    style: Style = "solid"


def column(signal: str, index: int = 0) -> Callable[[Subject], Rows]:
    """The rows of one number of a signal; none where a run does not have it."""

    def rows(subject: Subject) -> Rows:
        found = subject.rows(signal)
        return found[:, [0, 1 + index]] if index + 1 < found.shape[1] else np.empty((0, 2))

    return rows


def signal_traces(
    subjects: Sequence[Subject], signal: str, role: str = "", style: Style = "solid", only: slice = slice(None)
) -> list[Trace]:
    """A trace for each number of a signal, named after its columns."""
    having = next((subject for subject in subjects if subject.has(signal)), None)
    if having is None:
        return []
    single = having.run.fields[signal].is_single_number
    names = [(0, "")] if single else list(enumerate(having.columns(signal)))[only]
    return [Trace(name, role, column(signal, index), style) for index, name in names]


def panels(
    subjects: Sequence[Subject], title: str, unit: str, traces: Sequence[Trace], *, height: int = 150
) -> Iterator[Panel]:
    """One panel of one run, or one for each component of several; none where nothing is recorded."""
    components = list(dict.fromkeys(trace.component for trace in traces))
    if len(subjects) == 1:
        curves = []
        for trace in traces:
            rows = trace.rows(subjects[0])
            if len(rows):
                colour = colours.of_index(components.index(trace.component))
                label = f"{trace.component} {trace.role}".strip()
                curves.append(Curve(label, rows[:, 0], rows[:, 1], colour, trace.style))
        if curves:
            yield Panel(title, unit, tuple(curves), height=height)
        return
    for component in components:
        curves = []
        for trace in traces:
            if trace.component != component:
                continue
            for subject in subjects:
                rows = trace.rows(subject)
                if len(rows):
                    label = f"{subject.label} {trace.role}".strip()
                    curves.append(Curve(label, rows[:, 0], rows[:, 1], subject.colour, trace.style))
        if curves:
            name = title if len(components) == 1 else f"{title}: {component}"
            yield Panel(name, unit, tuple(curves), height=height)
