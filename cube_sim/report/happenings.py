"""What happened in a run, in the order of time: by the scenario, as the controller took it, and how it ended."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf

import numpy as np

from cube_sim.report.markup import number
from cube_sim.report.subject import Subject
from cube_sim.report.warnings_told import Told, warnings_told
from cube_sim.run_conditions import BATTERY_EMPTY
from cube_sim.scenario.event_blocks import CurrentEventBlock

EVENT, PHASE, BELIEF, AUTHORITY, SUPPLY, WRENCH, WARNING, END = (
    *("event", "phase", "belief", "flies as"),
    *("battery", "wrench", "warning", "end"),
)
"""Kinds: what the scenario did, which leg of the mission began, what the controller believes, how the vehicle flies,
its battery, a wrench that was not made for a while, what else the log warns of, an early end."""

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
        until_s: until when it lasts [s]; None for what is over at once, or seen in the signals of the thrusters.
    """

    t: float
    kind: str
    text: str
    until_s: float | None = field(default=None, compare=False)


def happenings(subject: Subject) -> tuple[Happening, ...]:
    """All that is marked on the plots of a run."""
    found: list[Happening] = []
    for each in _of_each_kind(subject):
        found += each[:_AT_MOST]
        if len(each) > _AT_MOST:
            last = each[_AT_MOST]
            found.append(Happening(last.t, last.kind, f"and {len(each) - _AT_MOST} more until {each[-1].t:g} s"))
    found += _end(subject)
    return tuple(sorted(found, key=lambda each: each.t))


def lasting(subject: Subject, t: float) -> list[Happening]:
    """What began before a time t [s], or at it, and lasts until then at least.

    The nearest is first, but for an empty battery: what comes after it is its consequence.
    """
    every = [each for kind in _of_each_kind(subject) for each in kind]
    found = [each for each in every if each.until_s is not None and each.t <= t <= each.until_s]
    return sorted(found, key=lambda each: (each.kind != SUPPLY, -each.t))


def _of_each_kind(subject: Subject) -> tuple[list[Happening], ...]:
    """Everything but the end, each kind by itself and in the order of time."""
    told = warnings_told(subject)
    kinds = [
        list(_events(subject)),
        list(_phases(subject)),
        list(_beliefs(subject, told)),
        list(_authorities(subject)),
        list(_supply(subject)),
    ]
    empty = {BATTERY_EMPTY.begins} if kinds[-1] else set()  # the record has the fact
    by_sort: dict[str, list[Happening]] = {}
    for each in told:
        if not each.of_belief and each.text not in empty:
            kind = WRENCH if each.sort == WRENCH else WARNING
            by_sort.setdefault(each.sort, []).append(Happening(each.t, kind, each.text, each.until_s))
    return (*kinds, *by_sort.values())


def _events(subject: Subject) -> Iterator[Happening]:
    end = subject.run.end
    last = max(subject.run.recorded_s, 0.0 if end is None else end.simulated_s or 0.0)  # one may end the flight at once
    due = [event for event in sorted(subject.scenario.events, key=lambda each: each.at_s) if event.at_s <= last]
    currents = [event.at_s for event in due if isinstance(event, CurrentEventBlock)]
    for event in due:
        until = None if event.ends is None else event.ends[0]
        if isinstance(event, CurrentEventBlock):
            currents.pop(0)
            until = currents[0] if currents else inf
        yield Happening(event.at_s, EVENT, event.title, until)


def _phases(subject: Subject) -> Iterator[Happening]:
    count = len(subject.scenario.phases)
    for phase in subject.phases:
        yield Happening(phase.start_s, PHASE, f"phase {phase.number + 1} of {count}: {phase.name}")


def _beliefs(subject: Subject, told_of: list[Told]) -> Iterator[Happening]:
    said = {round(each.t, 9): each.text for each in told_of if each.of_belief}
    rows, names = subject.rows("health.believed"), subject.columns("health.believed")
    rows = rows[np.isfinite(rows).all(axis=1)]
    if not len(rows):
        return
    told = rows[0, 1:]
    for index in np.flatnonzero(np.any(np.diff(rows[:, 1:], axis=0) != 0, axis=1)) + 1:
        now = rows[index, 1:]
        changed = np.flatnonzero(np.abs(now - told) > _NOTICED)
        if len(changed):
            t = float(rows[index, 0])
            shares = ", ".join(f"{names[i]} {_share(float(now[i]))}" for i in changed)
            yield Happening(t, BELIEF, f"the controller believes: {said.get(round(t, 9), shares)}")
            told = np.where(np.abs(now - told) > _NOTICED, now, told)


def _share(share: float) -> str:
    return "dead" if share == 0 else "whole" if share == 1 else f"gives {100 * share:.0f} %"


def _authorities(subject: Subject) -> Iterator[Happening]:
    rows, labels = subject.rows("health.authority"), subject.labels("health.authority")
    rows = rows[np.isfinite(rows[:, 1])]
    for index in np.flatnonzero(np.diff(rows[:, 1])) + 1 if len(rows) else ():
        yield Happening(float(rows[index, 0]), AUTHORITY, f"flies as {labelled(labels, rows[index, 1])}")


def _supply(subject: Subject) -> Iterator[Happening]:
    rows = subject.rows("power.charge")
    empty = np.flatnonzero(rows[:, 1] <= 0.0)
    if subject.scenario.battery is not None and len(empty):
        yield Happening(float(rows[empty[0], 0]), SUPPLY, BATTERY_EMPTY.begins, inf)


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
