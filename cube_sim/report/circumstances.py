"""What else was the case when a check had its worst sample: the words of an answer, where the record has them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cube_sim.report.decimation import held
from cube_sim.report.happenings import happenings, labelled
from cube_sim.report.markup import number, seconds
from cube_sim.report.subject import Subject
from cube_sim.report.thruster_use import LOWER, UPPER

BEFORE_S = 5.0
"""A cause is looked for in so long a time before its effect (choice)."""


def circumstances(subject: Subject, t: float) -> list[str]:
    """Saturated and lost thrusters, wrenches not attained, how it flew, what had just happened.

    Args:
        subject: the run.
        t: the time in question [s].

    Returns:
        A line each; none where nothing was out of the ordinary.
    """
    start = max(t - BEFORE_S, 0.0)
    return [
        *_saturated(subject, start, t),
        *_lost(subject, t),
        *_wrench(subject, start, t),
        *_authority(subject, t),
        *_estimate(subject, t),
        *(f"at {seconds(each.t)}: {each.text}" for each in happenings(subject) if start <= each.t <= t),
    ]


def _saturated(subject: Subject, start: float, t: float) -> Iterator[str]:
    for use in subject.thrusters:
        for state, limit in ((UPPER, "upper"), (LOWER, "lower")):
            spans = [(max(a, start), min(b, t)) for a, b in use.spans(state) if b > start and a <= t]
            if not spans:
                continue
            lasted = sum(b - a for a, b in spans)
            now = spans[-1][1] >= t
            since = next((a for a, b in use.spans(state) if a <= t < b), None)
            if now and since is not None:
                yield f"{use.name} at its {limit} limit since {seconds(since)}"
            elif lasted >= 5 * use.period_s:
                yield f"{use.name} at its {limit} limit for {lasted:.2g} s of the {t - start:.2g} s before"


def _lost(subject: Subject, t: float) -> Iterator[str]:
    said: dict[str, list[str]] = {}
    names = subject.columns("health.efficiency")
    true, believed = (held(subject.rows(f"health.{each}"), np.array([t]))[0] for each in ("efficiency", "believed"))
    for name, share, thought in zip(names, true, believed, strict=False):
        if share < 1.0:
            state = "dead or stuck" if share == 0 else f"weak, {100 * share:.0f} %"
            unseen = "" if thought == share else f", believed to give {number(100 * float(thought), 3)} %"
            said.setdefault(state + unseen, []).append(name)
        elif thought < 1.0:
            state = f"whole, but believed to give {number(100 * float(thought), 3)} %"
            said.setdefault(state, []).append(name)
    yield from (f"{', '.join(which)} {state}" for state, which in said.items())


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
