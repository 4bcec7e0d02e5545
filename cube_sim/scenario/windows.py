"""From when to when a check looks at a run: by time, or by what the scenario lets happen."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple, Protocol

from pydantic import Field, WrapValidator

from cube_sim.scenario.event_blocks import AnyEvent
from cube_sim.scenario.values import refuse


def _name_or_number(value: Any, _: Any) -> int | str:
    """Told apart here: a union would say of a wrong value what is wrong with it as either."""
    if isinstance(value, str) or (isinstance(value, int) and not isinstance(value, bool) and value >= 0):
        return value
    refuse(f"must be the name of an event, or its number in the list of events, from 0; got {value!r}")


EventName = Annotated[str | int, WrapValidator(_name_or_number)]
FromS = Annotated[
    float | None,
    Field(description="Start of the window [s]; with from_event, after that event. Default: start of the run."),
]
ToS = Annotated[
    float | None, Field(description="End of the window [s]; with to_event, after that event. Default: end of the run.")
]
FromEvent = Annotated[
    EventName | None,
    Field(description="Event from which from_s counts, by its name or by its number in the list of events, from 0."),
]
ToEvent = Annotated[EventName | None, Field(description="Event from which to_s counts, likewise.")]


class Windowed(Protocol):
    """What has the keys of a window."""

    @property
    def from_s(self) -> float | None: ...  # noqa: D102
    @property
    def to_s(self) -> float | None: ...  # noqa: D102
    @property
    def from_event(self) -> str | int | None: ...  # noqa: D102
    @property
    def to_event(self) -> str | int | None: ...  # noqa: D102


class TimeWindow(NamedTuple):
    """A span of simulated time, both ends included.

    Attributes:
        start_s: None for the start of the run [s].
        end_s: None for its end [s].
    """

    start_s: float | None = None
    end_s: float | None = None

    def within(self, duration_s: float) -> tuple[float, float]:
        """Both ends as numbers, in a run of this duration [s]."""
        start = 0.0 if self.start_s is None else self.start_s
        return start, duration_s if self.end_s is None else min(self.end_s, duration_s)


def event_index(asked: str | int, events: Sequence[AnyEvent]) -> int | None:
    """Which event is meant by a name, or by a number in the list; None where there is none."""
    if isinstance(asked, int):
        return asked if asked < len(events) else None
    return next((index for index, event in enumerate(events) if event.name == asked), None)


def window_of(asked: Windowed, events: Sequence[AnyEvent] = ()) -> TimeWindow:
    """The window that a check asks for.

    Args:
        asked: its keys.
        events: of the scenario, among them those it names.
    """
    return TimeWindow(
        _counted(asked.from_s, asked.from_event, events),
        _counted(asked.to_s, asked.to_event, events),
    )


def _counted(seconds: float | None, event: str | int | None, events: Sequence[AnyEvent]) -> float | None:
    if event is None:
        return seconds
    index = event_index(event, events)
    if index is None:
        raise ValueError(f"no event {event!r}")
    return events[index].at_s + (seconds or 0.0)


def require_window(asked: Windowed) -> None:
    """Refuse keys of a window that fit no run."""
    if asked.from_s is not None and asked.from_event is None and asked.from_s < 0:
        refuse(f"must be at least 0, got {asked.from_s:g}; with from_event it may be negative", "from_s")
    if asked.to_s is not None and asked.to_event is None and asked.to_s <= 0:
        refuse(f"must be greater than 0, got {asked.to_s:g}; with to_event it may be negative", "to_s")
    if asked.from_event is None and asked.to_event is None:
        _require_not_empty(TimeWindow(asked.from_s, asked.to_s))


def require_window_inside(
    asked: Windowed, events: Sequence[AnyEvent] | None, duration_s: float | None, *below: str | int
) -> None:
    """Refuse a window that no run of the scenario has.

    Args:
        asked: its keys.
        events: of the scenario; None where they are wrong themselves.
        duration_s: of the run; None likewise.
        below: where the keys stand.
    """
    for key, event in (("from_event", asked.from_event), ("to_event", asked.to_event)):
        if event is not None and events is not None:
            require_event(event, events, *below, key)
    if events is None and not asked.from_event is asked.to_event is None:
        return
    window = window_of(asked, events or ())
    _require_not_empty(window, *below)
    if duration_s is None:
        return
    start, end = window
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


def require_event(event: str | int, events: Sequence[AnyEvent], *below: str | int) -> None:
    """Refuse the name, or the number, of an event that there is not."""
    if event_index(event, events) is None:
        known = "; ".join(f"{each.name or index}: {each.what}" for index, each in enumerate(events))
        refuse(f"no event {reprlib.repr(event)}; {f'there are {known}' if known else 'the scenario has none'}", *below)


def _require_not_empty(window: TimeWindow, *below: str | int) -> None:
    start, end = window
    if start is not None and end is not None and not start < end:
        refuse(f"the window is empty: from_s {start:g} is not before to_s {end:g}", *below, "to_s")
