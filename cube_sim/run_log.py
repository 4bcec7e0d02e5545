"""What is said during a run: sentences with a time and a level, and how the weighty ones are told in few lines."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

WEIGHTY = ("WARNING", "ERROR", "FATAL")
"""The levels that a run passes on to its reader; the rest stays in the recording."""

ALIKE = 3
"""So many sentences that differ in their numbers only are told one by one (choice)."""

_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w])")
"""A number that stands by itself: the 1 of a thruster called T1 belongs to its name."""


@dataclass(frozen=True)
class LogLine:
    """A sentence about the run.

    Attributes:
        t: simulated time [s].
        level: DEBUG, INFO, WARNING, ERROR or FATAL.
        text: the sentence.
    """

    t: float
    level: str
    text: str


@dataclass(frozen=True)
class LogEntry:
    """A sentence and how often it, or its like, was said.

    Attributes:
        first: the first of them.
        count: how many there are, 1 or more.
        last_s: simulated time of the last [s].
    """

    first: LogLine
    count: int
    last_s: float

    def __str__(self) -> str:
        """One line for readers, e.g. ``40.00 s  WARNING  T1: dead (+2 more like this, the last at 57.20 s)``."""
        first = self.first
        more = f" (+{self.count - 1} more like this, the last at {self.last_s:.2f} s)" if self.count > 1 else ""
        return f"{first.t:.2f} s  {first.level}  {' '.join(first.text.split())}{more}"


def gathered(lines: Iterable[LogLine]) -> tuple[LogEntry, ...]:
    """Tell a log in few entries.

    A run that chatters between two states says the same two sentences a thousand times; here they are two entries. Of
    sentences that differ in nothing but their numbers, `ALIKE` are told; the rest count as the last of these.

    Args:
        lines: in the order of time.

    Returns:
        In the order in which each was first said.
    """
    entries: dict[LogLine, LogEntry] = {}
    kinds: dict[tuple[str, str], list[LogLine]] = {}
    for line in lines:
        told = kinds.setdefault((line.level, _NUMBER.sub("#", line.text)), [])
        same = next((first for first in told if first.text == line.text), None)
        if same is None and len(told) < ALIKE:
            told.append(line)
            entries[line] = LogEntry(line, 1, line.t)
            continue
        first = same or told[-1]
        entries[first] = replace(entries[first], count=entries[first].count + 1, last_s=line.t)
    return tuple(entries.values())
