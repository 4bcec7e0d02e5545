"""Distributions of set-points all of whose values lie beyond what their actuator follows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cube_sim.mission.hull import CompiledHull
from cube_sim.scenario.event_blocks import SetpointEventBlock
from cube_sim.scenario.schema import Scenario
from cube_sim.vehicle.other_actuators import allowed_commands, other_actuators

_WHERE = re.compile(r"(?:vehicles\.(?P<vehicle>[^.]+)\.)?(?P<key>.+)", re.DOTALL)
_OF_TABLE = re.compile(r"setpoints\.(?P<name>.+)\.values(?:\.\d+)?", re.DOTALL)
_OF_EVENT = re.compile(r"events\.(?P<index>\d+)\.value")


class SetpointPath(NamedTuple):
    """Where a set-point of a scenario is.

    Attributes:
        vehicle: among several, whose; "" of one.
        key: of its own scenario.
    """

    vehicle: str
    key: str


def setpoint_path(path: str) -> SetpointPath | None:
    """Which set-point a dotted path may name; None for another key."""
    found = _WHERE.fullmatch(path)
    if found is None or not (_OF_TABLE.fullmatch(found["key"]) or _OF_EVENT.fullmatch(found["key"])):
        return None
    return SetpointPath(found["vehicle"] or "", found["key"])


def never_followed(scenario: Scenario, hull: CompiledHull, key: str, values: Sequence[Any], *, between: bool) -> str:
    """Why no sample of a distribution can be flown; "" where some may, and where the key is of no set-point.

    Args:
        scenario: of the vehicle.
        hull: that it flies.
        key: of the set-point, as in `SetpointPath`.
        values: what the distribution gives, a number or a list of numbers each.
        between: whether it gives what lies between them as well.
    """
    name = _actuator(scenario, key)
    there = other_actuators(hull.model, hull.vehicle)
    if name not in there or not values:
        return ""
    low, high = allowed_commands(hull.model, there[name].index)
    try:
        given = np.array([np.atleast_1d(np.asarray(value, dtype=np.float64)) for value in values])
    except ValueError:  # lists of several lengths, or no numbers: others say so
        return ""
    least, most = given.min(axis=0), given.max(axis=0)
    outside = ((most < low) | (least > high)).any() if between else ((given < low) | (given > high)).any(axis=1).all()
    if not outside:
        return ""
    unit = there[name].wanted_unit.replace("1", "").rjust(1)
    worst = int(np.argmax(np.maximum(most - high, low - least)))
    text = f"gives {least[worst]:g} to {most[worst]:g}, and {name} follows {low:g} to {high:g} {unit}".rstrip()
    return f"{text}: no sample of it can be flown"


def _actuator(scenario: Scenario, key: str) -> str:
    """Name of the actuator that a key tells something; "" for none."""
    if (of_table := _OF_TABLE.fullmatch(key)) is not None:
        return of_table["name"]
    of_event = _OF_EVENT.fullmatch(key)
    index = -1 if of_event is None else int(of_event["index"])
    event = scenario.events[index] if 0 <= index < len(scenario.events) else None
    return event.actuator if isinstance(event, SetpointEventBlock) else ""
