"""From when to when a check looks at a run: by time, or by what the scenario lets happen."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, NamedTuple, Self

from pydantic import Field, WrapValidator, model_validator

from cube_sim.scenario.event_blocks import AnyEvent
from cube_sim.scenario.phase_blocks import PhaseBlock
from cube_sim.scenario.statistic_keys import SparingBlock
from cube_sim.scenario.values import refuse


def _name_or_number(value: Any, what: str, whats: str) -> int | str:
    """Told apart here: a union would say of a wrong value what is wrong with it as either."""
    if isinstance(value, str) or (isinstance(value, int) and not isinstance(value, bool) and value >= 0):
        return value
    refuse(f"must be the name of {what}, or its number in the list of {whats}, from 0; got {value!r}")


def _event(value: Any, _: Any) -> int | str:
    return _name_or_number(value, "an event", "events")


def _phase(value: Any, _: Any) -> int | str:
    return _name_or_number(value, "a phase", "phases")


EventName = Annotated[str | int, WrapValidator(_event)]
PhaseName = Annotated[str | int, WrapValidator(_phase)]


class WindowKeys(SparingBlock):
    """When is looked: from when to when, by time, from an event, or in a phase of the mission."""

    sparing: ClassVar[frozenset[str]] = frozenset(("from_event", "to_event", "phase"))

    from_s: float | None = Field(
        default=None,
        description="Start of the window [s]; with from_event, after that event, with phase, after that phase begins."
        " Default: start of the run, or of the phase.",
    )
    to_s: float | None = Field(
        default=None,
        description="End of the window [s]; with to_event, after that event, with phase, after that phase begins."
        " Default: end of the run, or of the phase.",
    )
    from_event: EventName | None = Field(
        default=None,
        description="Event from which from_s counts, by its name or by its number in the list of events, from 0.",
    )
    to_event: EventName | None = Field(default=None, description="Event from which to_s counts, likewise.")
    phase: PhaseName | None = Field(
        default=None,
        description="Phase to which the window belongs, by its name or by its number in the list of phases, from 0;"
        " outside it nothing is looked at.",
    )

    @model_validator(mode="after")
    def _possible_window(self) -> Self:
        _require_possible(self)
        return self

    @property
    def in_phase(self) -> str:
        """For readers: " in phase way back"; nothing where the window belongs to none."""
        return "" if self.phase is None else f" in phase {self.phase}"


class TimeWindow(NamedTuple):
    """A span of simulated time, both ends included.

    Attributes:
        start_s: None for the start of the run [s].
        end_s: None for its end [s].
        phase: name or number of the phase from whose start both count, and whose start and end are meant where they are
            None; None: they are of the run.
    """

    start_s: float | None = None
    end_s: float | None = None
    phase: str | int | None = None

    def within(self, duration_s: float) -> tuple[float, float]:
        """Both ends as numbers, in a run of this duration [s]; of a phase, which may come at any time, the whole."""
        if self.phase is not None:
            return 0.0, duration_s
        start = 0.0 if self.start_s is None else self.start_s
        return start, duration_s if self.end_s is None else min(self.end_s, duration_s)


def event_index(asked: str | int, events: Sequence[AnyEvent]) -> int | None:
    """Which event is meant by a name, or by a number in the list; None where there is none."""
    if isinstance(asked, int):
        return asked if asked < len(events) else None
    return next((index for index, event in enumerate(events) if event.name == asked), None)


def phase_index(asked: str | int, names: Sequence[str]) -> int | None:
    """Which phase is meant by a name, the only one of that name, or by a number; None where there is none."""
    if isinstance(asked, int):
        return asked if asked < len(names) else None
    return names.index(asked) if names.count(asked) == 1 else None


def window_of(asked: WindowKeys, events: Sequence[AnyEvent] = ()) -> TimeWindow:
    """The window that a check asks for.

    Args:
        asked: its keys.
        events: of the scenario, among them those it names.
    """
    return TimeWindow(
        _counted(asked.from_s, asked.from_event, events),
        _counted(asked.to_s, asked.to_event, events),
        asked.phase,
    )


def _counted(seconds: float | None, event: str | int | None, events: Sequence[AnyEvent]) -> float | None:
    if event is None:
        return seconds
    index = event_index(event, events)
    if index is None:
        raise ValueError(f"no event {event!r}")
    return events[index].at_s + (seconds or 0.0)


def _require_possible(asked: WindowKeys) -> None:
    """Refuse keys of a window that fit no run."""
    for key, event in (("from_event", asked.from_event), ("to_event", asked.to_event)):
        if asked.phase is not None and event is not None:
            refuse("the window belongs to a phase, from whose start it counts: leave out one of the two", key)
    if asked.from_s is not None and asked.from_event is None and asked.from_s < 0:
        refuse(f"must be at least 0, got {asked.from_s:g}; with from_event it may be negative", "from_s")
    if asked.to_s is not None and asked.to_event is None and asked.to_s <= 0:
        refuse(f"must be greater than 0, got {asked.to_s:g}; with to_event it may be negative", "to_s")
    if asked.from_event is None and asked.to_event is None:
        _require_not_empty(TimeWindow(asked.from_s, asked.to_s))


class Schedule(NamedTuple):
    """What a scenario says of the time of its run, before it is flown.

    Attributes:
        events: that happen; None where they are wrong themselves.
        phases: one after another; None likewise.
        duration_s: of the run; None likewise.
    """

    events: Sequence[AnyEvent] | None
    phases: Sequence[PhaseBlock] | None
    duration_s: float | None


def require_window_inside(asked: WindowKeys, schedule: Schedule, *below: str | int) -> None:
    """Refuse a window that no run of the scenario has.

    Args:
        asked: its keys.
        schedule: of the scenario.
        below: where the keys stand.
    """
    events, phases, duration_s = schedule
    for key, event in (("from_event", asked.from_event), ("to_event", asked.to_event)):
        if event is not None and events is not None:
            require_event(event, events, *below, key)
    if events is None and not asked.from_event is asked.to_event is None:
        return
    if asked.phase is not None:
        if phases is not None:
            _require_inside_phase(asked, asked.phase, phases, *below)
        if duration_s is not None and asked.from_s is not None and asked.from_s >= duration_s:
            text = f"{asked.from_s:g} s after the phase begins the run has ended, at {duration_s:g} s"
            refuse(text, *below, "from_s", because=("duration_s",))
        return
    window = window_of(asked, events or ())
    _require_not_empty(window, *below)
    if duration_s is None:
        return
    start, end, _ = window
    at_start = "from_s" if asked.from_s is not None else "from_event"
    at_end = "to_s" if asked.to_s is not None else "to_event"
    if start is not None and start < 0:
        refuse(f"the window starts at {start:g} s, before the run", *below, at_start)
    if start is not None and start >= duration_s:
        text = f"the window starts at {start:g} s, the run ends at {duration_s:g} s"
        refuse(text, *below, at_start, because=("duration_s",))
    if end is not None and end <= 0:
        refuse(f"the window ends at {end:g} s, before the run", *below, at_end)
    if end is not None and end > duration_s:
        text = f"the window ends at {end:g} s, the run at {duration_s:g} s"
        refuse(text, *below, at_end, because=("duration_s",))


def _require_inside_phase(asked: WindowKeys, phase: str | int, phases: Sequence[PhaseBlock], *below: str | int) -> None:
    names = [each.name for each in phases]
    index = phase_index(phase, names)
    if index is None:
        alike = [str(i) for i, name in enumerate(names) if name == phase]
        if alike:
            refuse(f"phases {' and '.join(alike)} are both called '{phase}'; say which by its number", *below, "phase")
        known = "; ".join(f"{i}: {name}" for i, name in enumerate(names))
        refuse(
            f"no phase {reprlib.repr(phase)}; {f'there are {known}' if known else 'the scenario has none'}",
            *below,
            "phase",
        )
    lasts, last = phases[index].for_s, index + 1 == len(phases)
    if lasts is None or last:  # the last one goes on to the end of the run
        return
    if asked.from_s is not None and asked.from_s >= lasts:
        refuse(f"{asked.from_s:g} s after it begins the phase is over, which lasts {lasts:g} s", *below, "from_s")
    if asked.to_s is not None and asked.to_s > lasts:
        refuse(f"the window ends {asked.to_s:g} s after the phase begins, which lasts {lasts:g} s", *below, "to_s")


def require_event(event: str | int, events: Sequence[AnyEvent], *below: str | int) -> None:
    """Refuse the name, or the number, of an event that there is not."""
    if event_index(event, events) is None:
        known = "; ".join(f"{each.name or index}: {each.what}" for index, each in enumerate(events))
        refuse(f"no event {reprlib.repr(event)}; {f'there are {known}' if known else 'the scenario has none'}", *below)


def _require_not_empty(window: TimeWindow, *below: str | int) -> None:
    start, end, _ = window
    if start is not None and end is not None and not start < end:
        refuse(f"the window is empty: from_s {start:g} is not before to_s {end:g}", *below, "to_s")
