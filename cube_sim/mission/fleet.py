"""Several vehicles made ready to fly in one water."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco

from cube_sim.errors import ModelError, ScenarioError
from cube_sim.mission.disturbance import force_events, set_pushes
from cube_sim.mission.events import Events
from cube_sim.mission.hull import (
    CompiledHull,
    flown_hull,
    put_initial,
    set_physics,
    surface_parameters,
    thruster_parameters,
    water_parameters,
)
from cube_sim.mission.own.code import Codes
from cube_sim.mission.own.others import Others
from cube_sim.mission.prepare import Mission, mission_of
from cube_sim.recording.channels import Channel, Field
from cube_sim.scenario.distance_block import DISTANCE
from cube_sim.scenario.event_blocks import CurrentEventBlock
from cube_sim.scenario.fleet import SEPARATOR, FleetScenario, distance_name, of_vehicle
from cube_sim.scenario.fleet_loading import LoadedFleet
from cube_sim.scenario.named_signals import signal_mistakes
from cube_sim.scenario.shared import Shared
from cube_sim.vehicle.compiled_once import room
from cube_sim.vehicle.current import current_table
from cube_sim.vehicle.joining import ModelPart, compiled_together, joined_parameters, vehicle_in
from cube_sim.vehicle.mjcf.numeric_names import DENSITY
from cube_sim.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class FleetMission:
    """Everything a run of several vehicles needs, ready at time 0.

    Attributes:
        scenario: what was asked for.
        model: the compiled model of all of them, with water.
        data: its state, at their initial conditions.
        missions: that of each vehicle, by name; model and data are these.
        events: what happens to the water on the way.
        channels: what will be recorded, the channels of a vehicle under its name.
        alone: each vehicle in the model of its own file, which nobody flies.
    """

    scenario: FleetScenario
    model: mujoco.MjModel
    data: mujoco.MjData
    missions: Mapping[str, Mission]
    events: Events
    channels: tuple[Channel, ...]
    alone: Mapping[str, CompiledHull]

    @property
    def codes(self) -> Codes:
        """Code of the user's own, by the value in whose place it stands."""
        return {
            f"vehicles.{name}.{key}": code
            for name, mission in self.missions.items()
            for key, code in mission.codes.items()
        }


def prepare_fleet(loaded: LoadedFleet) -> FleetMission:
    """Build the missions of several vehicles; nothing is written.

    Raises:
        ScenarioError: a model does not fit its scenario, or the others; with position.
    """
    alone, mistakes = dict[str, CompiledHull](), list[str]()
    for name, one in loaded.vehicles.items():
        try:
            alone[name] = flown_hull(one)
        except ScenarioError as error:
            mistakes += error.mistakes
    if mistakes:
        raise ScenarioError([*dict.fromkeys(mistakes)])
    _require_one_density(loaded, alone)
    model, flown = _joined(loaded, alone)
    set_physics(model, loaded.scenario.together)
    data = mujoco.MjData(model)
    for name, one in loaded.vehicles.items():
        put_initial(model, data, flown[name].vehicle, one.scenario)
    vehicles = {name: hull.vehicle for name, hull in flown.items()}
    missions = {
        name: mission_of(one, alone[name], flown[name], data, _others(data, vehicles, name))
        for name, one in loaded.vehicles.items()
    }
    channels = fleet_channels(loaded.scenario, {name: mission.channels for name, mission in missions.items()})
    _require_signals(loaded, channels)
    _require_events_in_place(loaded)
    first = next(iter(missions.values()))
    events = Events(loaded.scenario.together, model, first.vehicle)
    return FleetMission(loaded.scenario, model, data, missions, events, channels, alone)


def _others(data: mujoco.MjData, vehicles: Mapping[str, Vehicle], name: str) -> Others:
    return Others(data, {other: vehicle for other, vehicle in vehicles.items() if other != name})


def fleet_channels(scenario: FleetScenario, of_each: Mapping[str, Sequence[Channel]]) -> tuple[Channel, ...]:
    """The channel table of a run of several vehicles: that of each under its name, and their distances.

    Args:
        scenario: of all of them.
        of_each: the channel table of each vehicle, by name.
    """
    table = [replace(channel, name=of_vehicle(name, channel.name)) for name, own in of_each.items() for channel in own]
    fields = tuple(
        Field(distance_name(pair), 1, "m", f"distance between the body origins of {' and '.join(pair)}")
        for pair in scenario.pairs
    )
    return (*table, *((Channel(DISTANCE, fields),) if fields else ()))


def _joined(loaded: LoadedFleet, alone: Mapping[str, CompiledHull]) -> tuple[mujoco.MjModel, dict[str, CompiledHull]]:
    """The model of all vehicles, and each in it.

    Vehicles of one file that has a hull for each of them share it; where they name the same hull there is a copy for
    each.
    """
    copies: list[dict[str, str]] = []  # of one file: hull -> vehicle
    of_file: list[str] = []
    for name, (_, vehicle) in alone.items():
        file = str(Path(loaded.vehicles[name].scenario.model).resolve())
        there = (copy for copy, its in zip(copies, of_file, strict=True) if its == file and vehicle.name not in copy)
        copy = next(there, None)
        if copy is None:
            copy = {}
            copies.append(copy)
            of_file.append(file)
        copy[vehicle.name] = name
    water = water_parameters(loaded.scenario.together)
    profile = loaded.scenario.world.current_profile  # with one, each model has a table of it already
    if water and profile is None and any(current_table(hull.model) is not None for hull in alone.values()):
        text = "a model has a current of its own by time and height, water:current: leave one of both out"
        raise ScenarioError([loaded.mistake("events", text)])
    single, parts, prefixes = len(copies) == 1, list[ModelPart](), dict[str, str]()
    for index, (copy, file) in enumerate(zip(copies, of_file, strict=True)):
        prefix = "" if single else f"{next(iter(copy.values()))}{SEPARATOR}"
        parameters: dict[str, Sequence[float]] = {} if index else dict(water)
        for name in copy.values():
            scenario = loaded.vehicles[name].scenario
            parameters |= {
                **surface_parameters(scenario),
                **scenario.parameters,
                **thruster_parameters(scenario, alone[name].vehicle),
            }
            prefixes[name] = prefix
        parts.append(ModelPart(file, prefix, parameters, again=file in of_file[:index]))
    pushes = {name: len(force_events(one.scenario)) for name, one in loaded.vehicles.items()}
    try:
        model = _one_model(loaded.shared, parts, sum(pushes.values()))
        vehicles = {name: vehicle_in(model, hull.vehicle, prefixes[name]) for name, hull in alone.items()}
    except ModelError as error:
        raise ScenarioError([loaded.mistake("vehicles", f"their models do not go together: {error}")]) from None
    first = 0
    for name, vehicle in vehicles.items():
        set_pushes(loaded.vehicles[name], model, vehicle, first)
        first += pushes[name]
    return model, {name: CompiledHull(model, vehicle) for name, vehicle in vehicles.items()}


def _one_model(shared: Shared | None, parts: Sequence[ModelPart], pushes: int) -> mujoco.MjModel:
    """The joined model; flights that share what they can compile it once, whatever their numbers."""
    if shared is None:
        return compiled_together(parts, pushes).model
    files = tuple((part.file, part.prefix, part.again, room(part.parameters)) for part in parts)
    once = shared.get(("fleet", files, pushes), lambda: compiled_together(parts, pushes))
    model = once.with_parameters(joined_parameters(parts))  # a flight changes its model
    return compiled_together(parts, pushes).model if model is None else model


def _require_one_density(loaded: LoadedFleet, alone: Mapping[str, CompiledHull]) -> None:
    """Refuse models in waters of different densities."""
    known: dict[str, float] = {}
    mistakes = list[str]()
    for name, hull in alone.items():
        own = loaded.vehicles[name]
        said = own.scenario.parameters.get(DENSITY)
        numerics = (hull.model.numeric(i) for i in range(hull.model.nnumeric))
        of_model = next(float(each.data.item(0)) for each in numerics if each.name.endswith(DENSITY))
        known[name] = of_model if said is None else said[0]
        first = next(iter(known))
        if known[name] != known[first]:
            own_file, other_file = (Path(loaded.vehicles[each].scenario.model).name for each in (name, first))
            text = (
                f"{DENSITY} is {known[name]:g} kg/m^3 in {own_file} of {name}, {known[first]:g} kg/m^3 in {other_file}"
                f" of {first}: there is one water; say which at the top of the file,"
                f' parameters: {{"{DENSITY}": [{known[first]:g}]}}'
            )
            place = ("parameters", DENSITY) if DENSITY in own.scenario.parameters else ("model",)
            mistakes.append(own.mistake(place, text))
    if mistakes:
        raise ScenarioError(mistakes)


def _require_signals(loaded: LoadedFleet, channels: Sequence[Channel]) -> None:
    """Refuse checks over several vehicles of signals that none of them records."""
    widths = {f"{channel.name}.{field.name}": field.width for channel in channels for field in channel.fields}
    mistakes = [loaded.mistake(*found) for found in signal_mistakes(loaded.scenario.checks, widths)]
    if mistakes:
        raise ScenarioError(mistakes)


def _require_events_in_place(loaded: LoadedFleet) -> None:
    """Refuse events of the water after the end of the run, or said of one vehicle."""
    duration = loaded.scenario.duration_s
    mistakes = [
        one.mistake(f"events.{i}", "changes the water of all vehicles: say it in the events at the top of the file")
        for one in loaded.vehicles.values()
        for i, event in enumerate(one.scenario.events)
        if isinstance(event, CurrentEventBlock)
    ]
    mistakes += [
        loaded.mistake(f"events.{i}.at_s", f"{event.at_s:g} s is not before the end of the run at {duration:g} s")
        for i, event in enumerate(loaded.scenario.world.events)
        if event.at_s >= duration
    ]
    if mistakes:
        raise ScenarioError(mistakes)
