"""A scenario written out in full, defaults included, to be saved beside what it produced."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.representer import RoundTripRepresenter

from cube_sim.scenario.file_names import renamed
from cube_sim.scenario.fleet import AT_THE_TOP, VEHICLES, FleetScenario
from cube_sim.scenario.schema import Scenario


class _Representer(RoundTripRepresenter):
    """Writes null where the round-trip default leaves an empty place."""

    def represent_none(self, data: None) -> Any:
        return self.represent_scalar("tag:yaml.org,2002:null", "null")


_Representer.add_representer(type(None), _Representer.represent_none)


def seen_from(scenario: Scenario, directory: Path) -> Scenario:
    """The same scenario with the files it names relative to a folder, so that all may move together.

    Files with which the folder shares nothing but the root of the file system stay absolute.
    """
    here = directory.resolve()

    def relative(file: str) -> str:
        if Path(file).parts[:2] != here.parts[:2]:
            return file
        return Path(os.path.relpath(file, here)).as_posix()

    return renamed(scenario, relative)


def to_yaml(scenario: Scenario) -> str:
    """YAML text that `load` turns into an equal scenario."""
    # Most scenarios are of one flight, and a run is of one always.
    left_out = {"samples"} if scenario.samples is None else set()
    return _text(scenario.model_dump(mode="python", exclude=left_out))


def fleet_to_yaml(fleet: FleetScenario) -> str:
    """YAML text that `load_any` turns into an equal scenario of several vehicles."""
    vehicles = {name: one.model_dump(mode="python", exclude={*AT_THE_TOP}) for name, one in fleet.vehicles.items()}
    left_out = {"samples"} if fleet.samples is None else set()
    return _text({**fleet.world.model_dump(mode="python", exclude=left_out), VEHICLES: vehicles})


def _text(data: dict[str, Any]) -> str:
    yaml = YAML(typ="rt", pure=True)
    # No folding: a long description stays one line.
    yaml.width = 2**31
    yaml.Representer = _Representer
    stream = io.StringIO()
    yaml.dump(_nodes(data), stream)
    return stream.getvalue()


def _nodes(value: Any) -> Any:
    if isinstance(value, dict):
        return CommentedMap((key, _nodes(item)) for key, item in value.items())
    if isinstance(value, list | tuple):
        sequence = CommentedSeq(_nodes(item) for item in value)
        if not any(isinstance(item, dict) for item in value):
            sequence.fa.set_flow_style()
        return sequence
    return value
