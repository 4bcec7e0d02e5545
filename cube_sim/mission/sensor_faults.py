"""The scenario's `sensor` events at work, and what of them a scenario's sensors cannot have."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, cos, radians
from typing import Any

from cube_sim.navigation.faults import HEALTHY, SensorFaults, outlier_below
from cube_sim.nearest import counted
from cube_sim.scenario import Scenario
from cube_sim.scenario.navigation_blocks import NavigationBlock
from cube_sim.scenario.sensor_event_block import SensorEventBlock

IMU = "imu"
_OF_THE_IMU = "zeros", "frozen", "biased", "recovered"
_NUMBERS = {IMU: 6, "dvl": 3, "position": 3, "depth": 1, "heading": 1}


def sensor_events(scenario: Scenario) -> list[tuple[int, SensorEventBlock]]:
    """Those that befall sensors, with their places among the events."""
    return [(i, event) for i, event in enumerate(scenario.events) if isinstance(event, SensorEventBlock)]


def sensor_faults(scenario: Scenario) -> SensorFaults | None:
    """The faults of a scenario's sensors, none of which has begun; None without sensors."""
    if scenario.navigation is None:
        return None
    events = [event for _, event in sensor_events(scenario)]
    late = max((event.delay_s for event in events if event.delay_s is not None), default=0.0)
    outliers = [event.sensor for event in events if event.state == "outliers"]
    return SensorFaults((IMU, *scenario.navigation.aids), _ticks(late, scenario.control_period_s), outliers)


class SensorEvents:
    """Carries out the `sensor` events of a run.

    Args:
        faults: of the sensors, changed here; None without sensors.
        period_s: of the ticks.
    """

    def __init__(self, faults: SensorFaults | None, period_s: float) -> None:
        self._faults, self._period = faults, period_s
        self._owners: dict[tuple[str, str], SensorEventBlock] = {}

    def begin(self, event: SensorEventBlock) -> None:
        """Let it happen."""
        if self._faults is None:
            return
        if event.state == "recovered":
            self._faults.recover(event.sensor)
            self._owners = {key: owner for key, owner in self._owners.items() if key[0] != event.sensor}
            return
        fields = _fields(event, self._period)
        self._faults.change(event.sensor, fields)
        self._owners |= {(event.sensor, name): event for name in fields}

    def end(self, event: SensorEventBlock) -> None:
        """Let it be over, but for what another event has changed since."""
        if self._faults is not None:
            over = [name for name in HEALTHY if self._owners.get((event.sensor, name)) is event]
            self._faults.change(event.sensor, {name: HEALTHY[name] for name in over})


def _fields(event: SensorEventBlock, period_s: float) -> dict[str, Any]:
    """What it changes in `cube_sim.navigation.faults.FAULT`."""
    match event.state:
        case "lost":
            limits = {
                "upright": None if event.tilt_above_deg is None else cos(radians(event.tilt_above_deg)),
                "deepest": event.deeper_than_m,
                "shallowest": event.shallower_than_m,
            }
            given = {name: limit for name, limit in limits.items() if limit is not None}
            return given or {"lost": True}
        case "outliers":
            size = event.size or 0.0
            size = radians(size) if event.sensor == "heading" else size
            return {"outlier_below": outlier_below(event.share or 0.0), "size": size}
        case "late":
            return {"late": _ticks(event.delay_s or 0.0, period_s)}
        case "biased":
            return {"offset": [*_offset(event), *[0.0] * (6 - len(event.offset or ()))]}
    return {event.state: True}


def _offset(event: SensorEventBlock) -> Iterator[float]:
    """What is added to a reading, in the units of the stage that reads."""
    for i, value in enumerate(event.offset or ()):
        yield radians(value) if event.sensor == "heading" or (event.sensor == IMU and i < 3) else value


def _ticks(delay_s: float, period_s: float) -> int:
    return ceil(delay_s / period_s - 1e-9)


def impossible_faults(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """What the scenario's sensors cannot have: dotted path and words."""
    navigation = scenario.navigation
    for i, event in sensor_events(scenario):
        at = f"events.{i}"
        if navigation is None:
            yield f"{at}.sensor", "the scenario has no navigation block, and so no sensors"
            continue
        names = IMU, *navigation.aids
        if event.sensor not in names:
            yield f"{at}.sensor", f"no sensor '{event.sensor}'; there are {', '.join(names)}"
            continue
        if event.sensor == IMU and event.state not in _OF_THE_IMU:
            text = f"the inertial unit cannot be {event.state}, there is no estimate without it"
            yield f"{at}.state", f"{text}; it can be {', '.join(_OF_THE_IMU)}"
        numbers = _numbers(event.sensor, navigation)
        if event.offset is not None and len(event.offset) != numbers:
            yield f"{at}.offset", f"{counted(len(event.offset), 'number')} for readings of {numbers}"


def _numbers(sensor: str, navigation: NavigationBlock) -> int:
    """How many numbers a reading has."""
    own = {each.name: each.components for each in navigation.own}
    return own[sensor] if sensor in own else _NUMBERS[sensor]
