"""The windows of each check, in seconds, and what the scenario's duration and events make of them."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nextafter
from typing import NamedTuple

from cube_sim.scenario.check_blocks import (
    AnyCheck,
    BaselineCheckBlock,
    BeforeAfterCheckBlock,
    ConditionCheckBlock,
    EventuallyCheckBlock,
    ProgressCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
)
from cube_sim.scenario.event_blocks import AnyEvent
from cube_sim.scenario.statistic_keys import AsksStatistic
from cube_sim.scenario.values import refuse
from cube_sim.scenario.windows import (
    Schedule,
    TimeWindow,
    WindowKeys,
    event_index,
    require_event,
    require_window_inside,
    window_of,
)


def before_and_after(check: BeforeAfterCheckBlock, events: Sequence[AnyEvent]) -> tuple[TimeWindow, TimeWindow]:
    """The window that ends at the event, without its instant, and the one after it."""
    index = event_index(check.event, events)
    if index is None:
        raise ValueError(f"no event {check.event!r}")
    at_s = events[index].at_s
    return TimeWindow(at_s - check.before_s, nextafter(at_s, -inf)), TimeWindow(
        at_s + check.delay_s, at_s + check.delay_s + check.after_s
    )


def condition_window(check: ConditionCheckBlock, events: Sequence[AnyEvent] = ()) -> TimeWindow:
    """The window in which a condition has to hold."""
    window = window_of(check, events)
    if isinstance(check, EventuallyCheckBlock) and check.within_s is not None:
        return window._replace(end_s=(window.start_s or 0.0) + check.within_s)
    return window


def windows_of(check: AnyCheck, events: Sequence[AnyEvent] = ()) -> tuple[TimeWindow, ...]:
    """All windows at which a check looks; the whole run where it has no keys for one."""
    match check:
        case SignalCheckBlock() | BaselineCheckBlock() | ProgressCheckBlock():
            return (window_of(check, events),)
        case ConditionCheckBlock():
            return (condition_window(check, events),)
        case RatioCheckBlock():
            return window_of(check.numerator, events), window_of(check.denominator, events)
        case BeforeAfterCheckBlock():
            return before_and_after(check, events)
        case _:
            return (TimeWindow(),)


class AskedStatistic(NamedTuple):
    """A statistic that a check asks for.

    Attributes:
        asked: which, of which signal.
        window: in which.
        place: dotted path, within the check, of the block that asks; "" for the check itself.
        end_key: the key there that says where the window ends, or else where it starts; "signal" where none does.
    """

    asked: AsksStatistic
    window: TimeWindow
    place: str
    end_key: str


def statistics_of(check: AnyCheck, events: Sequence[AnyEvent] = ()) -> tuple[AskedStatistic, ...]:
    """Every statistic that a check asks for."""
    match check:
        case SignalCheckBlock():
            return (AskedStatistic(check, window_of(check, events), "", _end_key(check)),)
        case BaselineCheckBlock() if check.asked is not None:
            return (AskedStatistic(check.asked, window_of(check, events), "", _end_key(check)),)
        case RatioCheckBlock():
            above, below = check.numerator, check.denominator
            return (
                AskedStatistic(above, window_of(above, events), "numerator", _end_key(above)),
                AskedStatistic(below, window_of(below, events), "denominator", _end_key(below)),
            )
        case BeforeAfterCheckBlock():
            before, after = before_and_after(check, events)
            return AskedStatistic(check, before, "", "before_s"), AskedStatistic(check, after, "", "after_s")
        case _:
            return ()


def _end_key(asked: WindowKeys) -> str:
    for key in ("to_s", "to_event", "from_s", "from_event", "phase"):
        if getattr(asked, key) is not None:
            return key
    return "signal"


def require_windows_inside(checks: Sequence[AnyCheck], schedule: Schedule) -> None:
    """Refuse windows that stick out of the run: they could only be found wanting after the flight.

    Args:
        checks: of a scenario.
        schedule: of it.
    """
    events, _, duration_s = schedule
    for index, check in enumerate(checks):
        match check:
            case SignalCheckBlock() | ConditionCheckBlock() | BaselineCheckBlock() | ProgressCheckBlock():
                require_window_inside(check, schedule, index)
            case RatioCheckBlock():
                require_window_inside(check.numerator, schedule, index, "numerator")
                require_window_inside(check.denominator, schedule, index, "denominator")
            case BeforeAfterCheckBlock() if events is not None:
                require_event(check.event, events, index, "event")
                before, after = before_and_after(check, events)
                _require_room(before, after, duration_s, index)
            case _:
                continue
        if events is not None:
            _require_time_left(check, events, duration_s, index)


def _require_room(before: TimeWindow, after: TimeWindow, duration_s: float | None, index: int) -> None:
    if before.start_s is not None and before.start_s < 0:
        refuse(f"the window before the event starts at {before.start_s:g} s, before the run", index, "before_s")
    if duration_s is not None and after.end_s is not None and after.end_s > duration_s * (1 + 1e-12):
        text = f"the window after the event ends at {after.end_s:g} s, the run at {duration_s:g} s"
        refuse(text, index, "after_s", because=("duration_s",))


def _require_time_left(check: AnyCheck, events: Sequence[AnyEvent], duration_s: float | None, index: int) -> None:
    """Refuse times that are asked for beyond the end of the window."""
    if duration_s is None:
        return
    start, end = windows_of(check, events)[0].within(duration_s)
    if isinstance(check, EventuallyCheckBlock) and check.within_s is not None and start + check.within_s > duration_s:
        text = f"{check.within_s:g} s after the start of the window, {start:g} s, the run has ended"
        refuse(f"{text}, at {duration_s:g} s", index, "within_s", because=("duration_s",))
    if isinstance(check, SignalCheckBlock) and check.statistic == "settling":
        key = "at_least" if check.at_most is None else "at_most"
        limit = check.bound.limit
        if not limit < end - start:
            text = f"settling is timed in the window, which is {end - start:g} s long: {limit:g} s must be less"
            refuse(text, index, key, because=("duration_s",))
