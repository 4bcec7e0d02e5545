"""Several vehicles in one scenario file: which keys are whose, and where the file says what holds for each.

Keys of the world stand at the top. A key of a vehicle at the top is what each vehicle has that does not say otherwise
in its own block below `vehicles`; blocks are laid over each other key by key. What comes of it for one vehicle is an
ordinary `Scenario`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal
from zlib import crc32

import numpy as np
from pydantic import Field, field_validator
from pydantic.types import Strict

from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.current_block import CurrentProfileBlock
from cube_sim.scenario.distance_block import DISTANCE, AnyFleetCheck, DistanceCheckBlock
from cube_sim.scenario.document import Location
from cube_sim.scenario.event_blocks import CurrentEventBlock
from cube_sim.scenario.explain import Refusal
from cube_sim.scenario.include import VEHICLES, merged_data
from cube_sim.scenario.samples_block import SamplesBlock
from cube_sim.scenario.schema import PhysicsBlock, Scenario
from cube_sim.scenario.values import Block, Coordinate, Name, Vector3, refuse
from cube_sim.scenario.windows import WindowKeys

WORLD = (
    "schema_version",
    "description",
    "duration_s",
    "physics",
    "control_period_s",
    "current_m_s",
    "current_profile",
    "surface_m",
)
"""Keys of a scenario that are the same for all its vehicles."""
AT_THE_TOP = ("name", *WORLD, "samples")
"""Keys that no vehicle's block has."""
NOT_HANDED_DOWN = ("name", "events", "checks", "samples", VEHICLES)
"""Keys that at the top say something else than for a vehicle."""
SEPARATOR = "/"
"""Between the name of a vehicle and that of what is recorded of it."""

_NAME, _LONGEST_NAME = re.compile(r"[a-z][a-z0-9_]*"), 50


class WorldBlock(Block):
    """What is the same for all vehicles of a mission."""

    schema_version: Literal[1] = Field(description="Version of this file format.")
    name: Name = Field(description="Letters, digits, '_', '-', '.'; names the run's folder.")
    description: str = Field(default="", description="What the scenario shows, for readers.")
    seed: int = Field(default=0, ge=0, lt=2**63, description="Root of every random stream.")
    duration_s: float = Field(gt=0, le=86400, description="Simulated time [s], a day at most.")
    physics: PhysicsBlock = PhysicsBlock()
    control_period_s: float = Field(default=0.02, gt=0, le=10, description="Time between two thruster commands [s].")
    current_m_s: Vector3 = Field(default=(0.0, 0.0, 0.0), description="Velocity of the water, world axes [m/s].")
    current_profile: CurrentProfileBlock | None = Field(
        default=None, description="The current by depth, in place of current_m_s. Default: the same at every depth."
    )
    surface_m: Coordinate | None = Field(default=0.0, description="Height of the water's surface, world axes [m].")
    events: Annotated[tuple[CurrentEventBlock, ...], Strict(False)] = Field(
        default=(), description="What happens to the water during the run."
    )
    checks: Annotated[tuple[AnyFleetCheck, ...], Strict(False)] = Field(
        default=(), description="What the run must show of several vehicles."
    )
    samples: SamplesBlock | None = Field(default=None, description="Many flights of it, each with values of its own.")

    @field_validator("samples")
    @classmethod
    def _of_no_thrusters(cls, samples: SamplesBlock | None) -> SamplesBlock | None:
        if samples is not None and samples.lost_thrusters is not None:
            refuse("are those of one vehicle: give it events, in vary or by a generator", "lost_thrusters")
        return samples

    @field_validator("checks")
    @classmethod
    def _in_no_phase(cls, checks: tuple[AnyFleetCheck, ...]) -> tuple[AnyFleetCheck, ...]:
        for i, check in enumerate(checks):
            parts = {"numerator": check.numerator, "denominator": check.denominator} if check.kind == "ratio" else {}
            for key, asked in {"": check, **parts}.items():
                if isinstance(asked, WindowKeys) and asked.phase is not None:
                    text = "phases are of one vehicle: ask it among the checks of that vehicle, or say from_s and to_s"
                    refuse(text, i, *([key] if key else []), "phase")
        return checks


@dataclass(frozen=True)
class FleetScenario:
    """A mission of several vehicles in the same water.

    Attributes:
        world: what is the same for all of them.
        vehicles: what each does, by its name, in the order of the file.
        together: what is asked of several, as a scenario whose signals are those that all of them record.
    """

    world: WorldBlock
    vehicles: Mapping[str, Scenario]
    together: Scenario = field(compare=False)

    @property
    def name(self) -> str:
        """Names the run's folder."""
        return self.world.name

    @property
    def description(self) -> str:
        """What it shows, for readers."""
        return self.world.description

    @property
    def seed(self) -> int:
        """Root of every random stream."""
        return self.world.seed

    @property
    def duration_s(self) -> float:
        """Simulated time [s]."""
        return self.world.duration_s

    @property
    def control_period_s(self) -> float:
        """Time between two thruster commands [s]."""
        return self.world.control_period_s

    @property
    def first(self) -> Scenario:
        """That of the first vehicle: of whatever is the same for all."""
        return next(iter(self.vehicles.values()))

    @property
    def ticks(self) -> int:
        """Whole control periods in the run."""
        return self.first.ticks

    @property
    def steps_per_tick(self) -> int:
        """Physics steps in one control period."""
        return self.first.steps_per_tick

    @property
    def checks(self) -> tuple[AnyCheck, ...]:
        """Those over several vehicles, as checks of recorded signals."""
        return self.together.checks

    @property
    def samples(self) -> SamplesBlock | None:
        """Many flights of it, each with values of its own; None for one."""
        return self.world.samples

    @property
    def all_checks(self) -> Mapping[str, AnyCheck]:
        """Those of each vehicle and those over several, by what they are called in results, in their order."""
        own = {f"{name}: {check.title}": check for name, one in self.vehicles.items() for check in one.checks}
        return own | {check.title: check for check in self.checks}

    def as_data(self) -> dict[str, Any]:
        """As a file would hold it, with every default."""
        return {**self.world.model_dump(), VEHICLES: {name: one.model_dump() for name, one in self.vehicles.items()}}

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Every two vehicles, in the order of the file."""
        return pairs_of(tuple(self.vehicles))


def pairs_of(names: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Every two of some names, in their order."""
    return tuple((a, b) for i, a in enumerate(names) for b in names[i + 1 :])


def together_data(data: Mapping[str, Any], world: WorldBlock, found: Sequence[Share]) -> dict[str, Any]:
    """What is asked of several vehicles, as the file of one has it: checks of signals, events of the water.

    Args:
        data: of the file.
        world: the same.
        found: what it says of each vehicle.
    """
    pairs = pairs_of([share.name for share in found])
    checks = [
        check.of_signal(pairs).model_dump(mode="python") if isinstance(check, DistanceCheckBlock) else given
        for check, given in zip(world.checks, data.get("checks") or [], strict=True)
    ]
    said = {"name": world.name, "description": world.description, "seed": world.seed}
    return {**found[0].data, **said, "checks": checks, "events": data.get("events") or []}


def distance_name(pair: tuple[str, str]) -> str:
    """The recorded field that is the distance between two vehicles."""
    return "_to_".join(pair)


def of_vehicle(name: str, what: str) -> str:
    """What a channel, or a signal, of a vehicle is called in the record of all."""
    return f"{name}{SEPARATOR}{what}"


def names_several(data: Any) -> bool:
    """Whether the data of a scenario file are of several vehicles."""
    return isinstance(data, dict) and VEHICLES in data


@dataclass(frozen=True)
class Share:
    """What a file says of one vehicle.

    Attributes:
        name: of the vehicle.
        top: the data of the file.
        own: those of its block.
    """

    name: str
    top: Mapping[str, Any]
    own: Mapping[str, Any]

    @property
    def data(self) -> dict[str, Any]:
        """As the file of this vehicle alone would have it."""
        default = {key: value for key, value in self.top.items() if key not in NOT_HANDED_DOWN}
        default |= {"name": self.name, "description": "", "checks": []}
        default["seed"] = vehicle_seed(self.top.get("seed", 0), self.name)
        own = {key: value for key, value in self.own.items() if key not in AT_THE_TOP}
        return merged_data(own, default)[0]

    def place(self, location: Location) -> Location:
        """Where in the whole file a value stands, or would stand, that stands there in the file of this vehicle."""
        if location and location[0] in AT_THE_TOP:
            return location
        own, top = _depth(self.own, location), _depth(self.top, location)
        if location and location[0] in NOT_HANDED_DOWN:
            top = 0
        return location if top > own else (VEHICLES, self.name, *location)

    def misplaced(self) -> Iterator[Refusal]:
        """Keys of its block that belong to the top."""
        for key in AT_THE_TOP:
            if key in self.own:
                text = "is the same for all vehicles: it stands at the top of the file"
                yield Refusal((VEHICLES, self.name, key), text, at_key=True)


def shares(data: Mapping[str, Any]) -> tuple[list[Share], list[Refusal]]:
    """What a file says of each vehicle, and what is wrong with the list of them."""
    blocks, refusals = data[VEHICLES], list[Refusal]()
    if not isinstance(blocks, dict) or not blocks:
        text = "must be a block of names, each with the keys of one vehicle; for example leader: {path: ...}"
        return [], [Refusal((VEHICLES,), text, at_key=False)]
    found = []
    for name, own in blocks.items():
        if not isinstance(name, str) or len(name) > _LONGEST_NAME or not _NAME.fullmatch(name):
            text = f"a vehicle's name has up to {_LONGEST_NAME} small letters, digits and _, a letter first"
            refusals.append(Refusal((VEHICLES, name), text, at_key=True))
        elif name == DISTANCE:
            refusals.append(Refusal((VEHICLES, name), "is what all of them record; take another name", at_key=True))
        elif own is not None and not isinstance(own, dict):
            refusals.append(Refusal((VEHICLES, name), "must be a block of keys of this vehicle", at_key=False))
        else:
            share = Share(name, data, own or {})
            refusals += share.misplaced()
            found.append(share)
    return found, refusals


def vehicle_seed(seed: Any, name: str) -> Any:
    """The root of a vehicle's random streams, by its name and not by its place among the others."""
    if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
        return seed  # what is wrong with it is said of it
    sequence = np.random.SeedSequence(seed, spawn_key=(crc32(name.encode()),))
    return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(1))


def _depth(data: Any, location: Location) -> int:
    """How many steps of a location lead somewhere."""
    for depth, step in enumerate(location):
        if isinstance(data, Mapping) and step in data:
            data = data[step]  # type: ignore[index]
        elif isinstance(data, list) and isinstance(step, int) and step < len(data):
            data = data[step]
        else:
            return depth
    return len(location)
