"""What happened in a run, in the order of time: by the scenario, as the controller took it, and how it ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cube_sim.report.markup import number
from cube_sim.report.subject import Subject

EVENT, BELIEF, AUTHORITY, END = "event", "belief", "flies as", "end"
"""Kinds: what the scenario did, what the controller believes, how the vehicle flies, an early end."""

_AT_MOST = 12
"""So many of a kind are told; a run that chatters would cover its plots with lines (choice)."""
_NOTICED = 0.02
"""A believed share of force that changes by less is no news (choice)."""


@dataclass(frozen=True)
class Happening:
    """Something that happened.

    Attributes:
        t: when [s].
        kind: one of those above.
        text: for readers.
    """

    t: float
    kind: str
    text: str


def happenings(subject: Subject) -> tuple[Happening, ...]:
    """All that is marked on the plots of a run."""
    found: list[Happening] = []
    for told in (_events(subject), _beliefs(subject), _authorities(subject)):
        each = list(told)
        found += each[:_AT_MOST]
        if len(each) > _AT_MOST:
            last = each[_AT_MOST]
            found.append(Happening(last.t, last.kind, f"and {len(each) - _AT_MOST} more until {each[-1].t:g} s"))
    found += _end(subject)
    return tuple(sorted(found, key=lambda each: each.t))


def _events(subject: Subject) -> Iterator[Happening]:
    end = subject.run.end
    last = max(subject.run.recorded_s, 0.0 if end is None else end.simulated_s or 0.0)  # one may end the flight at once
    for event in sorted(subject.scenario.events, key=lambda each: each.at_s):
        if event.at_s > last:
            continue
        yield Happening(event.at_s, EVENT, event.title)


def _beliefs(subject: Subject) -> Iterator[Happening]:
    rows, names = subject.rows("health.believed"), subject.columns("health.believed")
    rows = rows[np.isfinite(rows).all(axis=1)]
    if not len(rows):
        return
    told = rows[0, 1:]
    for index in np.flatnonzero(np.any(np.diff(rows[:, 1:], axis=0) != 0, axis=1)) + 1:
        now = rows[index, 1:]
        changed = np.flatnonzero(np.abs(now - told) > _NOTICED)
        if len(changed):
            shares = ", ".join(f"{names[i]} {_share(float(now[i]))}" for i in changed)
            yield Happening(float(rows[index, 0]), BELIEF, f"the controller believes: {shares}")
            told = np.where(np.abs(now - told) > _NOTICED, now, told)


def _share(share: float) -> str:
    return "dead" if share == 0 else "whole" if share == 1 else f"gives {100 * share:.0f} %"


def _authorities(subject: Subject) -> Iterator[Happening]:
    rows, labels = subject.rows("health.authority"), subject.labels("health.authority")
    rows = rows[np.isfinite(rows[:, 1])]
    for index in np.flatnonzero(np.diff(rows[:, 1])) + 1 if len(rows) else ():
        yield Happening(float(rows[index, 0]), AUTHORITY, f"flies as {labelled(labels, rows[index, 1])}")


def _end(subject: Subject) -> list[Happening]:
    last, planned = subject.run.recorded_s, subject.scenario.duration_s
    ends = [line for line in subject.run.log if line.level in ("ERROR", "FATAL")]
    if not subject.run.complete and last < planned - subject.scenario.control_period_s:
        return [Happening(last, END, "the record ends here")]
    return [Happening(line.t, END, f"the run ends: {_why(line.text)}") for line in ends[-1:] if line.t < planned]


def _why(text: str) -> str:
    return text.removesuffix(": the run ends here")


def labelled(labels: tuple[str, ...], code: float) -> str:
    """The name of a code, or the number where it has none."""
    known = np.isfinite(code) and 0 <= int(code) < len(labels)
    return labels[int(code)] if known else number(float(code))
