"""The page: which section comes after which."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from cube_sim.report import colours
from cube_sim.report.check_panels import check_panels
from cube_sim.report.drawing import HALF, WIDE, draw
from cube_sim.report.guides import captions
from cube_sim.report.happenings import (
    AUTHORITY,
    BELIEF,
    END,
    EVENT,
    PHASE,
    SUPPLY,
    WARNING,
    WRENCH,
    Happening,
    happenings,
)
from cube_sim.report.html_table import badge, name_of
from cube_sim.report.lanes import StateLane, draw_lanes
from cube_sim.report.map_view import plan_view
from cube_sim.report.markup import element, seconds, text
from cube_sim.report.motion_panels import (
    depth_panels,
    error_panels,
    fin_panels,
    joint_panels,
    navigation_panels,
    power_panels,
    sensor_names,
    sensor_panels,
    setpoint_panels,
    thruster_panels,
    velocity_panels,
    water_panels,
    wrench_panels,
)
from cube_sim.report.panel import Mark, Panel, TimeAxis
from cube_sim.report.source_tables import build_table, log_table, parameter_table
from cube_sim.report.style import CSS, GAP, SCRIPT
from cube_sim.report.subject import NO_VERDICT, Subject, subjects_of
from cube_sim.report.tables import check_table, comparison_table, happening_table, sensor_table, thruster_table
from cube_sim.report.thruster_use import STATES
from cube_sim.runs.recorded_run import RecordedRun

_OF_KIND = {
    **{EVENT: colours.BAD, PHASE: colours.FAINT, BELIEF: colours.ORANGE, AUTHORITY: colours.PURPLE},
    **{SUPPLY: colours.BAD, WARNING: colours.ORANGE, WRENCH: colours.FAINT, END: colours.BLACK},
}
_OF_STATE = ("", "#8fb8de", "#f0b37a", "#b6bcc4", "#7a1fa2", "#c4231c")
_OF_CODES = ("#cfe8d5", *(colours.of_index(i) for i in (1, 3, 4, 5, 0, 6, 7, 2)))


def report(runs: Sequence[RecordedRun], labels: Sequence[str]) -> str:
    """The page of one run, or of several side by side.

    Args:
        runs: one or more.
        labels: a short name for each, all different.

    Returns:
        HTML that is well-formed XML, with all it needs inside; of the same runs and labels the same text.
    """
    subjects, together = subjects_of(runs, labels)
    told = _told(subjects)
    last = max(subject.run.recorded_s for subject in subjects)
    end_s = last if last > 0 else max(subject.scenario.duration_s for subject in subjects)
    # Of several runs each has its own gaps and phases: their curves are broken there.
    gaps, phases = (subjects[0].gaps, subjects[0].phases) if len(subjects) == 1 else ((), ())
    marks = tuple(Mark(each.t, flag, _OF_KIND[each.kind]) for flag, each, _ in told)
    axis = TimeAxis(0.0, end_s, marks, gaps, tuple((each.start_s, each.end_s, each.name) for each in phases))
    sections = [(name, title, content) for name, title, content in _sections(subjects, together, axis, told) if content]
    names = ", ".join(dict.fromkeys(subject.scenario.name for subject in subjects))
    links = "".join(f'<a href="#{name}">{text(title)}</a>' for name, title, _ in sections)
    body = [
        GAP if any(subject.gaps for subject in subjects) else "",
        *(_head(subjects) if not together else _head_of_several(subjects, together)),
        element("nav", links),
        *(f'<section id="{name}"><h2>{text(title)}</h2>{content}</section>' for name, title, content in sections),
        _foot(subjects),
        element("script", SCRIPT),
    ]
    verdicts = ", ".join(dict.fromkeys(subject.verdict for subject in subjects))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"/>'
        '<meta name="viewport" content="width=device-width, initial-scale=1"/>'
        f"<title>{text(names)}: {text(verdicts)}</title><style>{CSS}</style></head>\n"
        "<body>" + "\n".join(body) + "</body></html>\n"
    )


def _head_of_several(subjects: Sequence[Subject], together: Sequence[Subject]) -> Iterable[str]:
    """Of runs of several vehicles each, then the vehicles."""
    for whole in together:
        yield f"<h1>{text(whole.scenario.name)} {badge(_verdict(whole))}</h1>"
        yield f"<p>{text(whole.scenario.description)}</p>" if whole.scenario.description else ""
    yield from list(_head(subjects))[1:]


def _verdict(whole: Subject) -> str:
    return NO_VERDICT if whole.run.end is None or whole.run.end.verdict is None else whole.run.end.verdict


def _head(subjects: Sequence[Subject]) -> Iterable[str]:
    alone = len(subjects) == 1
    if not alone:
        names = ", ".join(dict.fromkeys(subject.scenario.name for subject in subjects))
        yield f"<h1>{len(subjects)} runs: {text(names)}</h1>"
    for subject in subjects:
        scenario, run = subject.scenario, subject.run
        if alone:
            yield f"<h1>{text(scenario.name)} {badge(subject.verdict)}</h1>"
            yield f"<p>{text(scenario.description)}</p>" if scenario.description else ""
        else:
            yield f"<p>{name_of(subject)} {badge(subject.verdict)} {text(scenario.description)}</p>"
        yield from (
            f'<p class="remark">{"" if alone else text(subject.label) + ": "}{text(r)}</p>' for r in subject.remarks
        )
        yield from _missing(subject, alone)
        flown = f"recorded to {seconds(run.recorded_s)} of {seconds(scenario.duration_s)}"
        facts = [flown, f"model {run.header.model.removeprefix('model/')}", f"seed {run.header.seed}"]
        facts.append(f"cube-sim {run.header.versions.get('cube-sim', 'of unknown version')}")
        yield f'<p class="fact">{text(" · ".join(facts))}</p>'


def _missing(subject: Subject, alone: bool) -> Iterable[str]:
    """Which seconds are not there, and how that is seen below."""
    if not subject.gaps:
        return
    spans = ", ".join(f"{seconds(start)} to {seconds(end)}" for start, end in subject.gaps)
    lost = sum(end - start for start, end in subject.gaps)
    whose = "" if alone else f"{subject.label}: "
    drawn = "they are hatched in the plots" if alone else "the curves are broken there"
    said = f"{whose}not recorded: {spans}, {seconds(lost)} in all; {drawn}, and the checks saw the rest alone"
    yield f'<p class="remark">{text(said)}</p>'


def _sections(
    subjects: Sequence[Subject],
    together: Sequence[Subject],
    axis: TimeAxis,
    told: Sequence[tuple[str, Happening, Sequence[Subject]]],
) -> Iterable[tuple[str, str, str]]:
    alone = len(subjects) == 1
    checks = check_table(subjects[0]) if alone else comparison_table(subjects)
    for whole in together:
        checks += f"<p>{name_of(whole)}</p>{check_table(whole)}" if whole.scenario.checks else ""
    over_several = [panel for whole in together for panel in check_panels([whole])]
    yield "checks", "Checks" if alone else "Side by side", checks
    yield "events", "What happened", happening_table(subjects, told) if told else ""
    yield (
        "margins",
        "Margins",
        "".join(_with_captions(panel, axis) for panel in (*check_panels(subjects), *over_several)),
    )
    # Only what happened in the first run has a place on its track.
    own = [mark for mark, (_, _, whose) in zip(axis.marks, told, strict=True) if subjects[0] in whose]
    plan, depth = plan_view(subjects, own), _drawn(depth_panels(subjects), axis, HALF)
    yield "path", "Path", f'<div class="two"><div>{plan}</div><div>{depth}</div></div>' if plan else depth
    yield "errors", "Errors", _drawn(error_panels(subjects), axis)
    yield "thrusters", "Thrusters", _thrusters(subjects, axis, told)
    yield "fins", "Fins", _drawn(fin_panels(subjects), axis)
    yield "setpoints", "Set-points", _drawn(setpoint_panels(subjects), axis)
    yield "joints", "Joints", _drawn(joint_panels(subjects), axis)
    yield "wrench", "Wrench", _drawn(wrench_panels(subjects), axis)
    yield "velocity", "Velocity", _drawn(velocity_panels(subjects), axis)
    yield "power", "Power and charge", _drawn(power_panels(subjects), axis)
    yield "water", "Water", _drawn(water_panels(subjects), axis)
    yield "navigation", "Navigation", _in_two(navigation_panels(subjects), axis)
    if sensor_names(subjects):
        yield "sensors", "Sensors", sensor_table(subjects) + _in_two(sensor_panels(subjects), axis)
    yield "log", "Log", "".join(_titled(subject, log_table(subject.run.log), alone) for subject in subjects)
    yield "parameters", "Parameters that are not the default", parameter_table(subjects)
    yield "build", "Build", build_table(subjects)


def _thrusters(
    subjects: Sequence[Subject], axis: TimeAxis, told: Sequence[tuple[str, Happening, Sequence[Subject]]]
) -> str:
    alone = len(subjects) == 1
    title = "What the thrusters do, how their wrench is allocated, and how the vehicle flies"
    states = ""
    for subject in subjects:
        # Lanes are of one run: what happened in others has no place on them.
        own = tuple(mark for mark, (_, _, whose) in zip(axis.marks, told, strict=True) if subject in whose)
        heading = title if alone else f"{subject.label}: {title}"
        states += draw_lanes(heading, _lanes(subject), replace(axis, marks=own, gaps=subject.gaps))
    tables = "".join(_titled(subject, thruster_table(subject), alone) for subject in subjects if subject.thrusters)
    forces = _in_two(thruster_panels(subjects), axis)
    return states + tables + forces if tables else ""


def _lanes(subject: Subject) -> list[StateLane]:
    lanes = []
    for signal, name in (("allocation.status", "allocation"), ("health.authority", "flies as")):
        rows, labels = subject.rows(signal), subject.labels(signal)
        if len(rows) and labels:
            codes = np.nan_to_num(rows[:, 1], nan=-1.0, posinf=-1.0, neginf=-1.0).astype(int)
            shown = tuple(_OF_CODES[min(i, len(_OF_CODES) - 1)] for i in range(len(labels)))
            lanes.append(StateLane(name, rows[:, 0], codes, labels, shown))
    return lanes + [StateLane(use.name, use.times, use.state, STATES, _OF_STATE) for use in subject.thrusters]


def _titled(subject: Subject, content: str, alone: bool) -> str:
    return content if alone else f"<p>{name_of(subject)}</p>{content}"


def _drawn(panels: Iterable[Panel], axis: TimeAxis, width: int = WIDE) -> str:
    return "".join(draw(panel, axis, width) for panel in panels)


def _with_captions(panel: Panel, axis: TimeAxis) -> str:
    said = "".join(
        element("p", text(words), class_="cap", style=f"color:{colour}") for words, colour in captions(panel)
    )
    return element("div", draw(panel, axis) + said, class_="figure")


def _in_two(panels: Iterable[Panel], axis: TimeAxis) -> str:
    """Two beside each other."""
    drawn = "".join(f"<div>{draw(panel, axis, HALF)}</div>" for panel in panels)
    return f'<div class="two">{drawn}</div>' if drawn else ""


def _told(subjects: Sequence[Subject]) -> list[tuple[str, Happening, Sequence[Subject]]]:
    """What happened in any run, in the order of time, with its flag and the runs in which it did."""
    whose: dict[Happening, list[Subject]] = {}
    for subject in subjects:
        for each in happenings(subject):
            whose.setdefault(each, []).append(subject)
    ordered = sorted(whose.items(), key=lambda item: item[0].t)
    return [(str(number), each, runs) for number, (each, runs) in enumerate(ordered, 1)]


def _foot(subjects: Sequence[Subject]) -> str:
    versions = dict.fromkeys(subject.run.header.versions.get("cube-sim", "unknown") for subject in subjects)
    axes = "World axes are ENU, body axes FLU, units SI."
    if any(happenings(subject) for subject in subjects):
        axes += " The numbers on dashed upright lines are those of What happened."
    moving = "Move over a plot to read its curves at that time; click to hold them there."
    said = f"Made by cube-sim report from what cube-sim {', '.join(versions)} recorded. Curves keep every peak. {axes}"
    return f'<footer><p>{text(said)} <span class="screen">{moving}</span></p></footer>'
