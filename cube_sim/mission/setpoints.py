"""The scenario's `setpoints`, and the events that change them: one table by time for each actuator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ScenarioError
from cube_sim.native.compiled import compiled
from cube_sim.nearest import among
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.event_blocks import SetpointEventBlock
from cube_sim.scenario.setpoint_block import SetpointsBlock
from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.laws.setpoint import TIME, VALUE, setpoint_at
from cube_sim.vehicle.other_actuators import OtherActuator, allowed_commands, driven_joint, other_actuators, stand_at
from cube_sim.vehicle.vehicle import Vehicle

Point = tuple[float, float]


class SetpointParts(NamedTuple):
    """The same as the loop commands it, in the memory of MuJoCo's data.

    Attributes:
        actuators: (k,) of `Setpoints`, like the next three.
        activations: (k,) of it.
        starts: (k+1,) of it.
        points: (n,2) of it.
        lengths: actuator_length of MuJoCo's data.
        wanted: (k,) commands of the moment, out.
    """

    actuators: NDArray[np.int_]
    activations: NDArray[np.int_]
    starts: NDArray[np.int64]
    points: Matrix
    lengths: Vector
    wanted: Vector


@dataclass(frozen=True)
class Setpoints:
    """What the k actuators of a run are told that a scenario commands, known ahead for all of it.

    Attributes:
        told: the actuators.
        actuators: (k,) indices into ctrl.
        activations: (k,) indices into act, of what each has reached; -1 where MuJoCo's actuator_length has it.
        starts: (k+1,) where the table of each begins among the points.
        points: (n,2) time [s] and command, as `cube_sim.vehicle.laws.setpoint` has them.
    """

    told: tuple[OtherActuator, ...]
    actuators: NDArray[np.int_]
    activations: NDArray[np.int_]
    starts: NDArray[np.int64]
    points: Matrix

    @property
    def names(self) -> tuple[str, ...]:
        """(k,) of the actuators."""
        return tuple(each.name for each in self.told)

    def at(self, t: float) -> Iterator[tuple[int, float]]:
        """Index of each actuator into ctrl, and its command at a time [s]."""
        for k, actuator in enumerate(self.actuators.tolist()):
            yield actuator, setpoint_at(self.points, int(self.starts[k]), int(self.starts[k + 1]), t)

    def begin(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Let every actuator stand where it is told to be at time 0, in data that are at their beginning."""
        for actuator, command in self.at(0.0):
            stand_at(model, data, actuator, command)


def commanded(scenario: Scenario) -> tuple[str, ...]:
    """Names of the actuators that a scenario commands, in the order in which it first names them."""
    events = [event.actuator for event in scenario.events if isinstance(event, SetpointEventBlock)]
    return tuple(dict.fromkeys([*scenario.setpoints, *events]))


def setpoints_of(scenario: Scenario, model: mujoco.MjModel, vehicle: Vehicle) -> Setpoints | None:
    """What a scenario commands; None for one that commands nothing.

    Args:
        scenario: that `require_possible_setpoints` lets pass.
        model: that flies.
        vehicle: in it.
    """
    names = commanded(scenario)
    if not names:
        return None
    there = other_actuators(model, vehicle)
    told = tuple(there[name] for name in names)
    tables = [_table(scenario, name) for name in names]
    return Setpoints(
        told,
        np.array([each.index for each in told], dtype=np.int_),
        np.array([each.activation for each in told], dtype=np.int_),
        np.cumsum([0, *map(len, tables)], dtype=np.int64),
        np.concatenate(tables),
    )


@compiled
def command_others(setpoints, t, ctrl):
    """Command the actuators of a scenario's set-points.

    Args:
        setpoints: `SetpointParts`; what is commanded is put there.
        t: simulated time [s].
        ctrl: MuJoCo's, changed here.
    """
    for k in range(len(setpoints.actuators)):
        command = setpoint_at(setpoints.points, setpoints.starts[k], setpoints.starts[k + 1], t)
        setpoints.wanted[k] = command
        ctrl[setpoints.actuators[k]] = command


def parts_of(setpoints: Setpoints | None, data: mujoco.MjData) -> SetpointParts:
    """What is commanded, as the loop commands it; without any actuator where nothing is.

    Args:
        setpoints: of a scenario.
        data: that flies.
    """
    if setpoints is None:
        none = np.zeros(0, np.int_)
        return SetpointParts(none, none, np.zeros(1, np.int64), np.zeros((0, 2)), data.actuator_length, np.zeros(0))
    each = setpoints.actuators, setpoints.activations, setpoints.starts, setpoints.points
    return SetpointParts(*each, data.actuator_length, np.zeros(len(setpoints.told)))


def require_possible_setpoints(loaded: Loaded, model: mujoco.MjModel, vehicle: Vehicle) -> None:
    """Refuse set-points that no actuator of the vehicle can be told.

    Raises:
        ScenarioError: with position.
    """
    scenario, there = loaded.scenario, other_actuators(model, vehicle)
    asked = [((f"setpoints.{name}"), name, block.values, "values") for name, block in scenario.setpoints.items()]
    asked += [
        (f"events.{i}", event.actuator, (event.value,), "value")
        for i, event in enumerate(scenario.events)
        if isinstance(event, SetpointEventBlock)
    ]
    mistakes = []
    for place, name, values, key in asked:
        of_event = key == "value"
        if name not in there:
            where = f"{place}.actuator" if of_event else ("setpoints", name)
            mistakes.append(loaded.mistake(where, _no_such(model, vehicle, name, there)))
            continue
        low, high = allowed_commands(model, there[name].index)
        for i, value in enumerate(values):
            if not low <= value <= high:
                unit = there[name].wanted_unit.replace("1", "").rjust(1)
                text = f"{name} follows {low:g} to {high:g} {unit}".rstrip() + f", not {value:g}"
                where = f"{place}.{key}" if of_event else ("setpoints", name, key, i)
                mistakes.append(loaded.mistake(where, text))
                break
    mistakes += [loaded.mistake(*each) for each in _told_twice(scenario)]
    if mistakes:
        raise ScenarioError(mistakes)


def _told_twice(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Events that tell one actuator two things at one time: where each stands, and what is wrong with it."""
    first: dict[tuple[str, float], int] = {}
    for i, event in enumerate(scenario.events):
        if isinstance(event, SetpointEventBlock):
            other = first.setdefault((event.actuator, event.at_s), i)
            if other != i:
                yield (
                    f"events.{i}.at_s",
                    f"'{event.actuator}' is told another value at {event.at_s:g} s, by event {other}",
                )


def _no_such(model: mujoco.MjModel, vehicle: Vehicle, name: str, there: dict[str, OtherActuator]) -> str:
    if name in vehicle.thrusters.names:
        return f"'{name}' is a thruster, which the allocation commands; {_others(there, name)}"
    if vehicle.fins is not None and name in vehicle.fins.names:
        return f"'{name}' turns a fin, which the allocation commands; {_others(there, name)}"
    joint = f"{vehicle.thrusters.prefix}{name}"
    drivers = [each.name for each in there.values() if _drives(model, each.index, joint)]
    if drivers:
        return f"no actuator '{name}' that takes set-points; the joint '{name}' is moved by {' and '.join(drivers)}"
    return f"no actuator '{name}' that takes set-points; {_others(there, name)}"


def _drives(model: mujoco.MjModel, actuator: int, joint: str) -> bool:
    index = driven_joint(model, actuator)
    return index >= 0 and model.joint(index).name == joint


def _others(there: dict[str, OtherActuator], name: str) -> str:
    return f"the model has {among(name, there)}" if there else "the model has none but thrusters and servos of fins"


def _table(scenario: Scenario, name: str) -> Matrix:
    """(n,2) of the points of one actuator, with what events make of them; times ascend, and repeat where it jumps."""
    block = scenario.setpoints.get(name)
    points = [(0.0, 0.0)] if block is None else _of_block(block)
    events = (event for event in scenario.events if isinstance(event, SetpointEventBlock) and event.actuator == name)
    for event in sorted(events, key=lambda event: event.at_s):
        # What was still to come of the table, or of an earlier event, does not come any more.
        before = setpoint_at(np.array(points), 0, len(points), event.at_s)
        points = [point for point in points if point[TIME] < event.at_s]
        points += [(event.at_s, before), (event.at_s + event.over_s, event.value)]
    return np.array(points, dtype=float)


def _of_block(block: SetpointsBlock) -> list[Point]:
    points: list[Point] = []
    for t, value in zip(block.times_s, block.values, strict=True):
        if points and block.between == "held":
            points.append((t, points[-1][VALUE]))
        points.append((t, value))
    return points
