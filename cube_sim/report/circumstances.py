"""What else was the case when a check had its worst sample: the words of an answer, where the record has them."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

import numpy as np

from cube_sim.recording.batch import Rows
from cube_sim.report.decimation import held
from cube_sim.report.happenings import SUPPLY, WRENCH, happenings, labelled, lasting
from cube_sim.report.markup import number, seconds
from cube_sim.report.subject import Subject
from cube_sim.report.thruster_use import LOWER, UPPER

BEFORE_S = 5.0
"""A cause is looked for in so long a time before its effect (choice)."""


def circumstances(subject: Subject, t: float) -> list[str]:
    """What had begun and was not over, saturated and lost thrusters, wrenches not attained, what had just happened.

    Args:
        subject: the run.
        t: the time in question [s].

    Returns:
        A line each: an empty battery, of which the rest is the consequence, what began last first, what has no
        beginning; none where nothing was out of the ordinary.
    """
    start = max(t - BEFORE_S, 0.0)
    still = lasting(subject, t)
    recent = [each for each in happenings(subject) if start <= each.t <= t]
    begun = [
        *((inf if each.kind == SUPPLY else each.t, f"{each.text} (since {seconds(each.t)})") for each in still),
        *_at_a_limit(subject, t),
        *_near_a_limit(subject, t),
        *_lost(subject, t),
    ]
    return [
        *(line for _, line in sorted(begun, key=lambda each: -each[0])),
        *_saturated(subject, start, t),
        *_wrench(subject, start, t),
        *_authority(subject, t),
        *_estimate(subject, t),
        *(f"at {seconds(each.t)}: {each.text}" for each in recent if each.kind != WRENCH and each not in still),
    ]


def _at_a_limit(subject: Subject, t: float) -> Iterator[tuple[float, str]]:
    for use in subject.thrusters:
        for state, limit in ((UPPER, "upper"), (LOWER, "lower")):
            since = next((a for a, b in use.spans(state) if a <= t < b), None)
            if since is not None:
                yield since, f"{use.name} at its {limit} limit since {seconds(since)}"


def _near_a_limit(subject: Subject, t: float) -> Iterator[tuple[float, str]]:
    for use in subject.thrusters:
        near = use.near_since(t)
        if near is not None and not any(a <= t < b for a, b in use.spans(LOWER, UPPER)):
            since, share, upper = near
            limit = "upper" if upper else "lower"
            yield since, f"{use.name} at {100 * share:.0f} % of its {limit} limit on average since {seconds(since)}"


def _saturated(subject: Subject, start: float, t: float) -> Iterator[str]:
    for use in subject.thrusters:
        for state, limit in ((UPPER, "upper"), (LOWER, "lower")):
            spans = [(max(a, start), min(b, t)) for a, b in use.spans(state) if b > start and a <= t]
            lasted = sum(b - a for a, b in spans)
            if spans and spans[-1][1] < t and lasted >= 5 * use.period_s:
                yield f"{use.name} at its {limit} limit for {lasted:.2g} s of the {t - start:.2g} s before"


def _lost(subject: Subject, t: float) -> Iterator[tuple[float, str]]:
    said: dict[tuple[float, str], list[str]] = {}
    names = subject.columns("health.efficiency")
    truths, beliefs = subject.rows("health.efficiency"), subject.rows("health.believed")
    true, believed = (held(rows, np.array([t]))[0] for rows in (truths, beliefs))
    for index, (name, share, thought) in enumerate(zip(names, true, believed, strict=False)):
        if share < 1.0:
            state = "dead or stuck" if share == 0 else f"weak, {100 * share:.0f} %"
            unseen = "" if thought == share else f", believed to give {number(100 * float(thought), 3)} %"
            said.setdefault((_since(truths, index, t), state + unseen), []).append(name)
        elif thought < 1.0:
            state = f"whole, but believed to give {number(100 * float(thought), 3)} %"
            said.setdefault((_since(beliefs, index, t), state), []).append(name)
    yield from (
        (since, f"{', '.join(which)} {state}, since {seconds(since)}") for (since, state), which in said.items()
    )


def _since(rows: Rows, column: int, t: float) -> float:
    """Since when a number has been what it is at a time [s]."""
    until = rows[(rows[:, 0] <= t) & np.isfinite(rows[:, 1 + column])]
    changes = np.flatnonzero(np.diff(until[:, 1 + column]))
    return float(until[changes[-1] + 1 if len(changes) else 0, 0])


def _wrench(subject: Subject, start: float, t: float) -> Iterator[str]:
    rows, labels = subject.rows("allocation.status"), subject.labels("allocation.status")
    inside = rows[(rows[:, 0] >= start) & (rows[:, 0] <= t)]
    inside = inside[np.isfinite(inside[:, 1])]
    other = inside[inside[:, 1] != 0]
    if len(other) and len(inside) > 1:
        lasted = len(other) * (inside[-1, 0] - inside[0, 0]) / (len(inside) - 1)
        which = ", ".join(labelled(labels, code) for code in np.unique(other[:, 1]))
        yield f"wrench not as demanded ({which}) for {lasted:.2g} s of the {t - start:.2g} s before"


def _authority(subject: Subject, t: float) -> Iterator[str]:
    rows = subject.rows("health.authority")
    if not len(rows):
        return
    code = held(rows, np.array([t]))[0, 0]
    if np.isfinite(code) and code != 0:
        yield f"flies as {labelled(subject.labels('health.authority'), code)}"


def _estimate(subject: Subject, t: float) -> Iterator[str]:
    rows = subject.rows("navigation_error.position")
    if len(rows):
        off = float(np.linalg.norm(held(rows, np.array([t]))[0]))
        yield f"position estimate off by {number(off, 2)} m"
