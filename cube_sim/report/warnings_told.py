"""What the log of a run warns of, and how long each of it lasts; what the record tells otherwise is left out."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from cube_sim.report.decimation import Values
from cube_sim.report.subject import Subject
from cube_sim.run_conditions import CONDITIONS, WRENCH_NOT_MADE, RunCondition
from cube_sim.run_log import WEIGHTY, LogLine, gathered

_SAME_S = 1e-9
"""Times that differ by less are the same: those of ticks are rounded [s]."""
_APART_S = 1.0
"""Stretches of wrenches that were not made are told as one where they are no further apart, as the log does [s]."""


@dataclass(frozen=True)
class Told:
    """A warning of the log.

    Attributes:
        t: when that begins of which it tells [s].
        text: the sentence.
        sort: the same of those that tell of the same sort of thing.
        until_s: until when it lasts [s], infinite for to the end; None for what is over at once.
        of_belief: whether it tells what the controller has come to believe of its thrusters.
    """

    t: float
    text: str
    sort: str
    until_s: float | None = None
    of_belief: bool = False


def warnings_told(subject: Subject) -> list[Told]:
    """The warnings of a run, in the order of time by sort; not those of the scenario's events, nor that of its end."""
    log = subject.run.log
    events = [(event.at_s, event.message) for event in subject.scenario.events]
    period = subject.scenario.control_period_s
    found: list[Told] = []
    others: list[LogLine] = []
    last_error = next((line for line in reversed(log) if line.level in ("ERROR", "FATAL")), None)
    for line in log:
        if line.level not in WEIGHTY or line is last_error:
            continue
        if any(line.text == said and abs(line.t - at) < period + _SAME_S for at, said in events):
            continue
        condition = next((each for each in CONDITIONS if line.text.startswith(each.begins)), None)
        if condition is not None:
            found.append(Told(line.t, line.text, condition.begins, _until(log, line, condition)))
        elif line.text.startswith(tuple(WRENCH_NOT_MADE.values())):
            found.append(Told(_not_made_since(subject, line.t), line.text, "wrench"))
        elif _is_of_belief(subject, line):
            found.append(Told(line.t, line.text, "belief", of_belief=True))
        else:
            others.append(line)
    for entry in gathered(others):
        more = f" (+{entry.count - 1} more like this, the last at {entry.last_s:g} s)" if entry.count > 1 else ""
        found.append(Told(entry.first.t, entry.first.text + more, "other"))
    return found


def _until(log: tuple[LogLine, ...], begun: LogLine, condition: RunCondition) -> float:
    """When a condition is said to be over, or to go on in another way."""
    later = log[next(index for index, line in enumerate(log) if line is begun) + 1 :]
    ends = (line.t for line in later if line.text == condition.ends or line.text.startswith(condition.begins))
    return next(ends, inf)


def _not_made_since(subject: Subject, told_s: float) -> float:
    """Since when wrenches had not been made of which the log tells at a time [s], by the statuses before it."""
    missed = _missed_before(subject, told_s)
    if not len(missed):
        return told_s
    breaks = np.flatnonzero(np.diff(missed) > _APART_S + _SAME_S)
    return float(missed[breaks[-1] + 1 if len(breaks) else 0])


def _missed_before(subject: Subject, told_s: float) -> Values:
    """Ticks up to a time [s] at which the wrench was not made, since the controller last changed its mind before it."""
    rows, believed = subject.rows("allocation.status"), subject.rows("health.believed")
    changes = believed[1:, 0][np.any(np.diff(believed[:, 1:], axis=0) != 0, axis=1)]
    earlier = changes[changes < told_s - _SAME_S]
    start = float(earlier[-1]) if len(earlier) else -inf
    inside = (rows[:, 0] >= start - _SAME_S) & (rows[:, 0] <= told_s + _SAME_S)
    return rows[inside & np.isfinite(rows[:, 1]) & (rows[:, 1] != 0), 0]


def _is_of_belief(subject: Subject, line: LogLine) -> bool:
    """Whether it is said when a belief changes, and names how the vehicle flies from then on, as the record does."""
    rows, labels = subject.rows("health.authority"), subject.labels("health.authority")
    index = int(np.searchsorted(rows[:, 0], line.t - _SAME_S)) if len(rows) else 0
    if not 0 < index < len(rows) or not np.isfinite(rows[index, 1]) or not labels:
        return False
    believed = subject.rows("health.believed")[index - 1 : index + 1, 1:]
    name = labels[int(rows[index, 1])]
    return bool(np.any(np.diff(believed, axis=0) != 0)) and f"; {name}: " in line.text
