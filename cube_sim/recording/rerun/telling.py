"""The story of a run, read from its scenario: apart from those who show it, who then need no scenario."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import ValidationError

from cube_sim.errors import RecordingError
from cube_sim.recording.among import header_of
from cube_sim.recording.header import RunHeader
from cube_sim.recording.rerun.story import Event, Limit, Story
from cube_sim.scenario import Scenario
from cube_sim.scenario.check_blocks import AnyCheck, SignalCheckBlock
from cube_sim.scenario.document import parse
from cube_sim.scenario.statistic_keys import AMONG_SAMPLES, statistic_alone
from cube_sim.scenario.windows import window_of


def story_of(header: RunHeader) -> Story:
    """What the header tells; of a scenario that this version does not know, nothing."""
    try:
        scenario = Scenario.model_validate(parse(header.resolved).data, context={"several": True})
    except ValidationError:
        return Story("", "", None, None, (), ())
    events = sorted((Event(event.at_s, event.title) for event in scenario.events), key=lambda event: event.t)
    checks = (check for check in scenario.checks if isinstance(check, SignalCheckBlock))
    limits = (_limit(check, scenario) for check in checks if _is_of_samples(check))
    name, speed = scenario.name, scenario.guidance.speed_m_s
    return Story(name, _text(scenario, events, header), scenario.duration_s, speed, tuple(events), tuple(limits))


def stories_of(header: RunHeader) -> dict[str, Story]:
    """Of a record of several vehicles, what it tells of each, by name."""
    try:
        return {name: story_of(header_of(name, header)) for name in header.vehicles}
    except RecordingError:
        return {name: Story("", "", None, None, (), ()) for name in header.vehicles}


def _text(scenario: Scenario, events: Sequence[Event], header: RunHeader) -> str:
    said = [f"# {scenario.name}", scenario.description]
    said.append(f"{scenario.duration_s:g} s, {header.model.removeprefix('model/')}, seed {header.seed}")
    if scenario.checks:
        said.append("## Checks")
        said.append("\n".join(f"- {_asked(check)}" for check in scenario.checks))
    if events:
        said.append("## Events")
        said.append("\n".join(f"- {event.t:g} s: {event.text}" for event in events))
    return "\n\n".join(part for part in said if part)


def _asked(check: AnyCheck) -> str:
    return f"{check.title} {_bound(check)}"


def _bound(check: AnyCheck) -> str:
    relation = {"<=": "≤", ">=": "≥"}[check.bound.relation]
    return f"{relation} {check.bound.limit:g}"


def _is_of_samples(check: SignalCheckBlock) -> bool:
    """Whether its limit is one on a number that is recorded."""
    return check.statistic in AMONG_SAMPLES and check.combine == "norm" and check.minus is None


def _limit(check: SignalCheckBlock, scenario: Scenario) -> Limit:
    start, end = window_of(check, scenario.events).within(scenario.duration_s)
    text = f"{statistic_alone(check)} {_bound(check)}{check.in_phase}"
    return Limit(check.signal, check.component, text, check.bound.limit, start, end)
