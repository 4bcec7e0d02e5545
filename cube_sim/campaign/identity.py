"""Which sweep it is: the scenario with its files, and the code that flies it.

The count of samples and the rate they must show are no part of it: they change no sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from typing import Any

from cube_sim.mission.input_files import input_files
from cube_sim.mission.own.code import codes_of, own_code
from cube_sim.mission.run_header import KERNEL, versions
from cube_sim.recording.header import COMMIT
from cube_sim.scenario import Scenario
from cube_sim.scenario.distribution_blocks import ChoiceBlock, GridBlock
from cube_sim.scenario.fleet import VEHICLES, FleetScenario
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet
from cube_sim.scenario.python_block import PythonBlock
from cube_sim.scenario.resolved import fleet_to_yaml, to_yaml
from cube_sim.scenario.samples_block import SamplesBlock

_OF_MACHINES = (KERNEL, COMMIT, "processor", "libc")
"""What may differ between those who fly one sweep; of a number the last digits may."""


@dataclass(frozen=True)
class Identity:
    """What makes two sweeps the same.

    Attributes:
        scenario: SHA-256 of the scenario with every default written out.
        files: name -> SHA-256 of every file it names, Python included.
        versions: of the packages that have a part in the numbers, and of cube_sim's source.
    """

    scenario: str
    files: Mapping[str, str]
    versions: Mapping[str, str]

    @property
    def digest(self) -> str:
        """Of all of it."""
        return sha256(repr(asdict(self)).encode()).hexdigest()[:16]

    def differences(self, other: Identity) -> list[str]:
        """What is not the same in another, in words."""
        found = [] if self.scenario == other.scenario else ["scenario"]
        found += [f"file {name}" for name in _differing(self.files, other.files)]
        return found + [f"version of {name}" for name in _differing(self.versions, other.versions)]

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def identity_of(loaded: AnyLoaded) -> Identity:
    """Which sweep a scenario with samples is.

    Raises:
        ScenarioError: code that it names cannot be found.
        OSError: a file that it names cannot be read.
    """
    several = isinstance(loaded, LoadedFleet)
    each = {f"{VEHICLES}.{name}.": one for name, one in loaded.vehicles.items()} if several else {"": loaded}
    inputs = {where: input_files(one.scenario) for where, one in each.items()}
    files = {
        f"{where}{name}": sha256(content).hexdigest()
        for where, found in inputs.items()
        for name, content in found.contents.items()
    }
    codes = {f"{where}{key}": code for where, one in each.items() for key, code in codes_of(one).items()}
    block = loaded.scenario.samples
    if block is not None and block.generator is not None:
        key, anchor = "samples.generator", loaded.whole if several else loaded
        codes[key] = own_code(anchor, key, PythonBlock.model_construct(**dict(block.generator)))
    for key, code in codes.items():
        beside = {**code.neighbours, **code.modules}
        files[f"{key}: {code.name}"] = code.digest
        files |= {f"{key}: {name}": sha256(content).hexdigest() for name, content in beside.items()}
    for path, distribution in (block.vary if block is not None else {}).items():
        if isinstance(distribution, ChoiceBlock | GridBlock):
            for value in distribution.values or ():
                place = loaded.path.parent / str(value)
                if isinstance(value, str) and place.is_file():
                    files[f"samples.vary.{path}: {value}"] = sha256(place.read_bytes()).hexdigest()
    known = {name: told for name, told in versions().items() if name not in _OF_MACHINES}
    if several:
        carried = {name: inputs[f"{VEHICLES}.{name}."].scenario for name in loaded.vehicles}
        text = _fleet_as_flown(replace(loaded.scenario, vehicles=carried))
    else:
        text = _as_flown(inputs[""].scenario)
    return Identity(sha256(text.encode()).hexdigest(), files, known)


def _as_flown(scenario: Scenario) -> str:
    """The text of a scenario, without what changes none of its samples."""
    return to_yaml(scenario.model_copy(update={"samples": _drawn(scenario.samples)}))


def _fleet_as_flown(fleet: FleetScenario) -> str:
    world = fleet.world.model_copy(update={"samples": _drawn(fleet.samples)})
    return fleet_to_yaml(replace(fleet, world=world))


def _drawn(samples: SamplesBlock | None) -> SamplesBlock | None:
    return None if samples is None else samples.model_copy(update={"count": None, "required": None})


def _differing(one: Mapping[str, str], other: Mapping[str, str]) -> list[str]:
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))
