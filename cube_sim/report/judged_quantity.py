"""The number that a check judges, over time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from cube_sim.checks import distance_to_allowed, margin_of, series_of
from cube_sim.checks.baseline_difference import SAME_INSTANT_S
from cube_sim.checks.reasons import NotJudgedError
from cube_sim.judged_store import beforehand_of
from cube_sim.recording.batch import Rows
from cube_sim.report.decimation import Values, held
from cube_sim.report.subject import Subject
from cube_sim.scenario.check_blocks import (
    AllowedForcesCheckBlock,
    AlwaysCheckBlock,
    AnyCheck,
    BaselineCheckBlock,
    BeforeAfterCheckBlock,
    ComparisonBlock,
    EventuallyCheckBlock,
    ExactWrenchCheckBlock,
    PathEndCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
)
from cube_sim.scenario.check_windows import windows_of
from cube_sim.scenario.statistic_keys import AMONG_SAMPLES, AsksStatistic


@dataclass(frozen=True)
class JudgedQuantity:
    """What a check looks at.

    Attributes:
        title: what it is; checks of the same quantity have the same title.
        unit: its unit.
        rows: (n, 2) time [s] and number; empty where it is not recorded.
        start_s: start of the window that is judged [s].
        end_s: its end [s].
        as_samples: whether the value is that of a sample, and not a mean over them.
        every_sample: whether no sample of the window may be beyond the limit.
        apart: whether value and limit are other numbers than these: a share, a count, a time, a ratio, a change.
        levels: numbers that the check itself names, in the unit.
        windows: from when to when is looked at [s], where that is more than one span.
        steps: whether a number holds until the next.
        codes: names of its values, where it is a code.
    """

    title: str
    unit: str
    rows: Rows
    start_s: float
    end_s: float
    as_samples: bool = True
    every_sample: bool = True
    apart: bool = False
    levels: tuple[float, ...] = ()
    windows: tuple[tuple[float, float], ...] = ()
    steps: bool = False
    codes: tuple[str, ...] = ()

    def at(self, t: float) -> float | None:
        """Its number at a time; None before the first."""
        value = held(self.rows, np.array([t]))[0, 0]
        return float(value) if np.isfinite(value) else None


def judged_quantities(subject: Subject, check: AnyCheck) -> tuple[JudgedQuantity, ...]:
    """Everything that a check looks at in a run, what its answer points at first."""
    if not isinstance(check, RatioCheckBlock):
        return (judged_quantity(subject, check),)
    both = check.numerator, check.denominator
    windows = [subject.span(each) for each in windows_of(check, subject.scenario.events)]
    return tuple(_apart(subject, *each) for each in zip(both, windows, strict=True))


def judged_quantity(subject: Subject, check: AnyCheck) -> JudgedQuantity:
    """The number that a check judges in a run."""
    end_s = subject.scenario.duration_s
    windows = [subject.span(window) for window in windows_of(check, subject.scenario.events)]
    match check:
        case SignalCheckBlock() if check.statistic not in AMONG_SAMPLES:
            return _apart(subject, check, windows[0])
        case SignalCheckBlock():
            return _of_signal(subject, check, windows[0])
        case AlwaysCheckBlock() | EventuallyCheckBlock():
            return _of_condition(subject, check, windows[0])
        case BaselineCheckBlock() if check.asked is not None:
            return _apart(subject, check.asked, windows[0])
        case BaselineCheckBlock():
            name, rows = _from_baseline(subject, check)
            steps = subject.is_held(check.signal)
            return JudgedQuantity(name, subject.unit(check.signal), rows, *windows[0], steps=steps)
        case RatioCheckBlock():
            return _apart(subject, check.numerator, windows[0])
        case BeforeAfterCheckBlock():
            whole = windows[0][0], windows[1][1]
            return replace(_apart(subject, check, whole), windows=tuple(windows))
        case AllowedForcesCheckBlock():
            allow_off = check.allow_off is not False
            return JudgedQuantity(
                "Distance of a force to its allowed set", "N", _to_allowed(subject, allow_off), 0, end_s
            )
        case ExactWrenchCheckBlock():
            return JudgedQuantity("|A f − F| where attainable", "N, N m", _wrench_error(subject), 0, end_s)
        case PathEndCheckBlock():
            return JudgedQuantity(
                "Distance to the end of the path, at most", "m", _to_end(subject), 0, end_s, every_sample=False
            )
        case _:  # one that is new: its result is told, and nothing drawn
            return JudgedQuantity(check.title, check.unit, np.empty((0, 2)), 0, end_s, apart=True)


def beyond_from(quantity: JudgedQuantity, relation: str, limit: float) -> float | None:
    """When a sample in the window is first beyond the limit [s]; None if none is."""
    rows = quantity.rows[(quantity.rows[:, 0] >= quantity.start_s) & (quantity.rows[:, 0] <= quantity.end_s)]
    beyond = np.flatnonzero(rows[:, 1] > limit if relation == "<=" else rows[:, 1] < limit)
    return float(rows[beyond[0], 0]) if len(beyond) else None


def _series(subject: Subject, asked: AsksStatistic | ComparisonBlock) -> tuple[str, Rows]:
    """What a signal, or the part of it that is asked for, is called, and its rows (n, 2)."""
    rows, name, columns = subject.rows(asked.signal), asked.signal, subject.columns(asked.signal)
    if asked.minus is not None:
        other, name = subject.rows(asked.minus), f"{name} − {asked.minus}"
        if rows.shape == other.shape:
            rows = np.column_stack([rows[:, 0], rows[:, 1:] - other[:, 1:]])
        else:
            rows = np.empty((0, rows.shape[1]))
    if asked.component is not None:
        known = asked.component < len(columns)
        name += f".{columns[asked.component]}" if known else f"[{asked.component}]"
        values = rows[:, 1 + asked.component] if known else np.full(len(rows), np.nan)
    else:
        values = series_of(rows[:, 1:], None, asked.combine)
        if rows.shape[1] != 2:
            name = {"norm": f"|{name}|", "sum": f"sum of {name}", "horizontal": f"|{name}| in x and y"}[asked.combine]
    return name, np.column_stack([rows[:, 0], values])


def _of_signal(subject: Subject, check: SignalCheckBlock, window: tuple[float, float]) -> JudgedQuantity:
    name, rows = _series(subject, check)
    sizes = check.statistic in ("max_abs", "min_abs") or (check.statistic == "rms" and check.at_most is not None)
    if sizes and np.nanmin(rows[:, 1], initial=np.inf) < 0:
        name, rows = f"|{name}|", np.abs(rows)
    upper, lower = ("max", "max_abs"), ("min", "min_abs")
    every = check.statistic == "max_abs" or check.statistic in (upper if check.at_least is None else lower)
    return JudgedQuantity(
        name,
        subject.unit(check.signal),
        rows,
        *window,
        as_samples=check.statistic not in ("rms", "mean", "percentile"),
        every_sample=every,
        steps=subject.is_held(check.signal),
        codes=subject.labels(check.signal),
    )


def _apart(subject: Subject, asked: AsksStatistic, window: tuple[float, float]) -> JudgedQuantity:
    """Of a statistic that is no number beside the samples."""
    name, rows = _series(subject, asked)
    levels = asked.band or (() if asked.level is None else (asked.level,))
    return JudgedQuantity(
        name,
        subject.unit(asked.signal),
        rows,
        *window,
        as_samples=False,
        every_sample=False,
        apart=True,
        levels=tuple(levels),
        windows=(window,),
        steps=subject.is_held(asked.signal),
        codes=subject.labels(asked.signal),
    )


def _from_baseline(subject: Subject, check: BaselineCheckBlock) -> tuple[str, Rows]:
    """How far a signal is from the same of an earlier run; no rows where that is not at hand."""
    name, ours = _series(subject, check.whole)
    title = f"{name}, distance from the baseline"
    run, rows = subject.run, subject.rows(check.signal)
    try:
        theirs = beforehand_of(run.scenario, run.recording.channels, run.header.inputs).baseline(check)
    except NotJudgedError:
        return title, np.empty((0, 2))
    if theirs.shape[1] != rows.shape[1] or (check.component or 0) >= rows.shape[1] - 1:
        return title, np.empty((0, 2))
    # Times are whole periods but for rounding: of each, the row that holds a little after it.
    apart = rows[:, 1:] - held(theirs, rows[:, 0] + SAME_INSTANT_S)
    distance = np.abs(series_of(apart, check.component, check.combine))
    return title, np.column_stack([ours[:, 0], distance])


def _of_condition(
    subject: Subject, check: AlwaysCheckBlock | EventuallyCheckBlock, window: tuple[float, float]
) -> JudgedQuantity:
    """The signal of the only comparison, or the margin of several."""
    always, first = isinstance(check, AlwaysCheckBlock), check.comparisons[0]
    if len(check.comparisons) == 1 and not check.scaled:
        name, rows = _series(subject, first)
        steps, labels = subject.is_held(first.signal), subject.labels(first.signal)
        unit = subject.unit(first.signal)
        return JudgedQuantity(name, unit, rows, *window, every_sample=always, steps=steps, codes=labels)
    parts = [_series(subject, each)[1] for each in check.comparisons]
    times = np.unique(np.concatenate([rows[:, 0] for rows in parts]))
    margins = [margin_of(each, held(rows, times)[:, 0]) for each, rows in zip(check.comparisons, parts, strict=True)]
    margin = np.min(margins, axis=0) if check.all else np.max(margins, axis=0)
    unit = "1" if check.scaled else subject.unit(first.signal)
    title = f"Margin of: {check.condition}"
    return JudgedQuantity(title, unit, np.column_stack([times, margin]), *window, every_sample=always)


def _to_allowed(subject: Subject, allow_off: bool) -> Rows:
    worst: Values | None = None
    times = np.zeros(0)
    for use in subject.thrusters:
        limits = held(use.limits, use.times)[:, None, :]
        distance = distance_to_allowed(use.force[:, None], limits, allow_off)[:, 0]
        times, worst = use.times, distance if worst is None else np.maximum(worst, distance)
    return np.column_stack([times, np.zeros(0) if worst is None else worst])


def _wrench_error(subject: Subject) -> Rows:
    forces, demanded = subject.rows("thrusters.force_demanded"), subject.rows("wrench.demanded")
    status, matrix = subject.rows("allocation.status"), subject.rows("actuation.matrix")
    m, fins = forces.shape[1] - 1, subject.rows("fins.wrench")
    if len(fins) == len(demanded):  # what is left to the thrusters
        demanded = np.column_stack([demanded[:, 0], demanded[:, 1:] - fins[:, 1:]])
    if not (len(forces) == len(demanded) == len(status)) or not len(matrix) or matrix.shape[1] != 1 + 6 * m:
        return np.empty((0, 2))
    index = np.maximum(np.searchsorted(matrix[:, 0], forces[:, 0], side="right") - 1, 0)
    error = np.empty(len(forces))
    others = np.flatnonzero(np.diff(index)) + 1  # with a battery there is another with each row
    for start, end in pairwise([0, *others, len(forces)]):
        if start < end:
            A = matrix[index[start], 1:].reshape(6, m)
            error[start:end] = np.linalg.norm(forces[start:end, 1:] @ A.T - demanded[start:end, 1:], axis=1)
    error[status[:, 1] != 0] = np.nan
    return np.column_stack([forces[:, 0], error])


def _to_end(subject: Subject) -> Rows:
    left, target, vehicle = (subject.rows(name) for name in ("target.remaining", "target.position", "pose.position"))
    if not len(left) == len(target) == len(vehicle):
        return np.empty((0, 2))
    distance = np.linalg.norm(vehicle[:, 1:] - target[:, 1:], axis=1) + np.abs(left[:, 1])
    return np.column_stack([left[:, 0], distance])
