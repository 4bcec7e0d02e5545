"""What is known of a run before its rows come."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from cube_sim.checks.reasons import NotJudgedError
from cube_sim.checks.samples import Array
from cube_sim.scenario.check_blocks import BaselineCheckBlock
from cube_sim.scenario.event_blocks import AnyEvent


def no_baseline(check: BaselineCheckBlock) -> Array:
    """Where nobody can read one.

    Raises:
        NotJudgedError: always.
    """
    raise NotJudgedError(f"{check.record} is not at hand")


@dataclass(frozen=True)
class Beforehand:
    """What checks are told of a run, beside its signals.

    Attributes:
        events: of its scenario, in the order of their list.
        held: names of the signals of which a row holds until the next.
        baseline: rows (n, 1 + width) of a check's signal in the run it compares with; a NotJudgedError where there are
            none.
        phases: names of the phases of its scenario, in the order of their list.
    """

    events: Sequence[AnyEvent] = ()
    held: Collection[str] = frozenset()
    baseline: Callable[[BaselineCheckBlock], Array] = no_baseline
    phases: Sequence[str] = ()
