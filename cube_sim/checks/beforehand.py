"""What is known of a run before its rows come."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from cube_sim.scenario.event_blocks import AnyEvent


@dataclass(frozen=True)
class Beforehand:
    """What checks are told of a run, beside its signals.

    Attributes:
        events: of its scenario, in the order of their list.
        held: names of the signals of which a row holds until the next.
    """

    events: Sequence[AnyEvent] = ()
    held: Collection[str] = frozenset()
