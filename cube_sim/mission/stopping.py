"""The scenario's `stop` list, as the loop looks at it."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

import numpy as np

from cube_sim.nearest import among
from cube_sim.recording.channels import Channel
from cube_sim.scenario import Scenario
from cube_sim.scenario.stop_blocks import (
    AnyStop,
    GivenUpStopBlock,
    PathEndStopBlock,
    PhasesEndStopBlock,
    SignalStopBlock,
)
from cube_sim.spatial import Record
from cube_sim.verdict import EarlyEnd

WATCHED = (
    "pose",
    "velocity",
    "target",
    "path_error",
    "reference",
    "wrench",
    "allocation",
    "thrusters",
    "power",
    "health",
    "water",
    "disturbance",
    "fins",
    "setpoints",
    "joints",
)
"""Channels with a row at every tick that the loop itself writes, in the order of their tables."""
SIGNAL, PATH_END, TIMED, RESTING = range(4)
"""Kinds of conditions."""
STOP = np.dtype(
    [
        ("kind", np.int64),
        ("table", np.int64),
        ("first", np.int64),
        ("count", np.int64),
        ("above", np.bool_),
        ("limit", np.float64),
        ("turned", np.float64),
        ("from_s", np.float64),
        ("until", np.float64),
        ("ticks", np.int64),
        ("held", np.int64),
    ]
)
"""One condition: its kind; of a signal the table, its first column and how many there are; whether it is to be above
the limit, else below; the largest attitude error beside the distance to a path's end [rad]; from when it is looked at
[s]; when it is over, met or not [s]; for how many ticks after the first it has to hold, and at how many it has in a row
by now."""
_SAME = 1e-9  # of a tick


class Stops:
    """The conditions of a run.

    Args:
        scenario: that has them.
        channels: what is recorded.

    Attributes:
        records: (n,) of `STOP`, those that are seen from the rows of a tick; the last is the end of a phase, where the
            mission has phases.
    """

    def __init__(self, scenario: Scenario, channels: tuple[Channel, ...]) -> None:
        self._seen = tuple(stop for stop in scenario.stop if isinstance(stop, SignalStopBlock | PathEndStopBlock))
        self._after_phases = next((stop for stop in scenario.stop if isinstance(stop, PhasesEndStopBlock)), None)
        self._given_up = next((stop for stop in scenario.stop if isinstance(stop, GivenUpStopBlock)), None)
        self._phased = bool(scenario.phases)
        self.records: Record = np.zeros(len(self._seen) + self._phased, STOP)
        self.records["turned"] = self.records["until"] = np.inf
        self.records["kind"] = RESTING
        for record, stop in zip(self.records, self._seen, strict=False):
            record["ticks"] = ceil(stop.for_s / scenario.control_period_s - _SAME)
            record["from_s"] = stop.from_s
            match stop:
                case SignalStopBlock():
                    record["kind"] = SIGNAL
                    record["table"], record["first"], record["count"] = _place(stop, channels)
                    record["above"] = stop.above is not None
                    record["limit"] = stop.below if stop.above is None else stop.above
                case PathEndStopBlock():
                    record["kind"], record["limit"] = PATH_END, stop.reach_m

    @property
    def phase(self) -> np.void:
        """The element of `records` that sees the end of a phase, of a mission that has them."""
        return self.records[-1]

    def ends_phase(self, index: int) -> bool:
        """Whether the condition of this number is the end of a phase, not of the run."""
        return self._phased and index == len(self._seen)

    def after_phases(self, t: float) -> EarlyEnd | None:
        """That the last phase is over at t [s]; None where that does not end a run."""
        return None if self._after_phases is None else _end(self._after_phases, t)

    def end(self, index: int, t: float) -> EarlyEnd:
        """That the condition of this number is met at t [s]."""
        return _end(self._seen[index], t)

    def given_up(self, reason: str, t: float) -> EarlyEnd | None:
        """That the path is given up for a reason at t [s]; None where that does not end a run."""
        return None if self._given_up is None else _end(self._given_up, t, f": {reason}")


def _end(stop: AnyStop, t: float, why: str = "") -> EarlyEnd:
    return EarlyEnd(t, stop.title + why, "PASS" if stop.verdict == "pass" else "FAIL")


def _place(stop: SignalStopBlock, channels: tuple[Channel, ...]) -> tuple[int, int, int]:
    """Table, first column and number of columns of a signal that is watched."""
    name, _, quantity = stop.signal.partition(".")
    channel = next(channel for channel in channels if channel.name == name)
    names = [field.name for field in channel.fields]
    columns = channel.columns[names.index(quantity)]
    if stop.component is not None:
        return WATCHED.index(name), columns.start + stop.component, 1
    return WATCHED.index(name), columns.start, columns.stop - columns.start


def impossible_stops(scenario: Scenario, channels: tuple[Channel, ...]) -> Iterator[tuple[str, str]]:
    """Conditions on signals that nobody can watch: dotted path and words."""
    widths = {f"{c.name}.{field.name}": field.width for c in channels if c.name in WATCHED for field in c.fields}
    recorded = {f"{c.name}.{field.name}" for c in channels for field in c.fields}
    for i, stop in enumerate(scenario.stop):
        if isinstance(stop, PhasesEndStopBlock) and not scenario.phases:
            yield f"stop.{i}.kind", "the scenario has no phases"
        if isinstance(stop, PathEndStopBlock) and scenario.phases:
            yield f"stop.{i}.kind", "the mission has a path for each phase; use phases_end"
        if not isinstance(stop, SignalStopBlock):
            continue
        if stop.signal in recorded - widths.keys():
            text = f"'{stop.signal}' is not known to the loop at every tick; there are {among(stop.signal, widths)}"
            yield f"stop.{i}.signal", text
        elif stop.signal not in widths:
            text = f"no signal '{stop.signal}' is recorded at every tick; there are {among(stop.signal, widths)}"
            yield f"stop.{i}.signal", text
        elif stop.component is not None and stop.component >= widths[stop.signal]:
            yield f"stop.{i}.component", f"{stop.signal} has columns 0 to {widths[stop.signal] - 1}"
