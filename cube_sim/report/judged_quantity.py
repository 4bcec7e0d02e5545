"""The number that a check judges, over time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import assert_never

import numpy as np

from cube_sim.checks import distance_to_allowed
from cube_sim.recording.batch import Rows
from cube_sim.report.decimation import Values, held
from cube_sim.report.subject import Subject
from cube_sim.scenario.check_blocks import (
    AllowedForcesCheckBlock,
    AnyCheck,
    ExactWrenchCheckBlock,
    PathEndCheckBlock,
    SignalCheckBlock,
)


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
        codes: names of its values, where it is a code.
    """

    title: str
    unit: str
    rows: Rows
    start_s: float
    end_s: float
    as_samples: bool = True
    every_sample: bool = True
    codes: tuple[str, ...] = ()

    def at(self, t: float) -> float | None:
        """Its number at a time; None before the first."""
        value = held(self.rows, np.array([t]))[0, 0]
        return float(value) if np.isfinite(value) else None


def judged_quantity(subject: Subject, check: AnyCheck) -> JudgedQuantity:
    """The number that a check judges in a run."""
    end_s = subject.scenario.duration_s
    match check:
        case SignalCheckBlock():
            return _of_signal(subject, check, end_s)
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
        case _:
            assert_never(check)


def beyond_from(quantity: JudgedQuantity, relation: str, limit: float) -> float | None:
    """When a sample in the window is first beyond the limit [s]; None if none is."""
    rows = quantity.rows[(quantity.rows[:, 0] >= quantity.start_s) & (quantity.rows[:, 0] <= quantity.end_s)]
    beyond = np.flatnonzero(rows[:, 1] > limit if relation == "<=" else rows[:, 1] < limit)
    return float(rows[beyond[0], 0]) if len(beyond) else None


def _of_signal(subject: Subject, check: SignalCheckBlock, end_s: float) -> JudgedQuantity:
    rows, name, unit = subject.rows(check.signal), check.signal, subject.unit(check.signal)
    columns = subject.columns(check.signal)
    if check.component is not None:
        known = check.component < len(columns)
        name += f".{columns[check.component]}" if known else f"[{check.component}]"
        values = rows[:, 1 + check.component] if known else np.full(len(rows), np.nan)
    elif rows.shape[1] == 2:
        values = rows[:, 1]
    else:
        name, values = f"|{name}|", np.linalg.norm(rows[:, 1:], axis=1)
    sizes = check.statistic == "max_abs" or (check.statistic == "rms" and check.at_most is not None)
    if sizes and np.nanmin(values, initial=np.inf) < 0:
        name, values = f"|{name}|", np.abs(values)
    return JudgedQuantity(
        name,
        unit,
        np.column_stack([rows[:, 0], values]),
        0.0 if check.from_s is None else check.from_s,
        end_s if check.to_s is None else check.to_s,
        check.statistic not in ("rms", "mean"),
        check.statistic == "max_abs" or (check.statistic, check.at_least is None) in (("max", True), ("min", False)),
        subject.labels(check.signal),
    )


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
    m = forces.shape[1] - 1
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
