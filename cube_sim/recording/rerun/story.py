"""What the scenario of a run says that its view shows: name, text, duration, events and the limits of checks."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Event:
    """Something that the scenario lets happen.

    Attributes:
        t: when [s].
        text: for readers.
    """

    t: float
    text: str


@dataclass(frozen=True)
class Limit:
    """The limit of a check on one number of a signal.

    Attributes:
        signal: "channel.field".
        column: which number of it; None for its norm.
        text: what is asked, for readers.
        value: the limit, in the signal's unit.
        start_s: start of the window that is judged [s].
        end_s: its end [s].
    """

    signal: str
    column: int | None
    text: str
    value: float
    start_s: float
    end_s: float


@dataclass(frozen=True)
class Story:
    """What a view tells beside the numbers.

    Attributes:
        name: of the scenario; "" where it cannot be read.
        text: the scenario in a few lines of Markdown.
        duration_s: how long the run is meant to last [s]; None when nobody knows.
        speed_m_s: along the path; None when nobody knows.
        events: in the order of time.
        limits: of the checks that name a signal.
    """

    name: str
    text: str
    duration_s: float | None
    speed_m_s: float | None
    events: tuple[Event, ...]
    limits: tuple[Limit, ...]
