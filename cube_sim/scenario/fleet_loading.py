"""A scenario file of one vehicle or of several, read with every mistake in it found at once."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cube_sim.errors import ScenarioError
from cube_sim.nearest import among
from cube_sim.scenario.document import Document, Location
from cube_sim.scenario.explain import Refusal, explain
from cube_sim.scenario.fleet import VEHICLES, FleetScenario, Share, WorldBlock, names_several, shares, together_data
from cube_sim.scenario.include import merged
from cube_sim.scenario.loading import Loaded, loaded_again, loaded_from, refused_lines, validated
from cube_sim.scenario.overrides import Override, apply
from cube_sim.scenario.possible_samples import sample_refusals
from cube_sim.scenario.python_block import python_blocks
from cube_sim.scenario.reading import parsed, read_text
from cube_sim.scenario.resolved import fleet_to_yaml, seen_from
from cube_sim.scenario.schema import Scenario
from cube_sim.scenario.shared import Shared


@dataclass(frozen=True)
class LoadedFleet:
    """A valid scenario of several vehicles and where it came from.

    Attributes:
        scenario: of all of them.
        vehicles: that of each, by name; mistakes found later are told with places in the one file.
        text: the file as written.
        path: the file, as given.
        overrides: what replaced values of the file.
        document: the file as parsed, with those it includes.
        bases: text of each file it includes, as `Loaded.bases`.
        shared: what many flights of variations of it share, as `Loaded.shared`; that of each vehicle is the same.
    """

    scenario: FleetScenario
    vehicles: Mapping[str, Loaded]
    text: str
    path: Path
    overrides: tuple[Override, ...]
    document: Document
    bases: Mapping[str, str]
    shared: Shared | None = field(default=None, compare=False, repr=False)

    def sharing(self) -> LoadedFleet:
        """The same scenario, whose variations share what all of them need."""
        shared = Shared(len(self.vehicles))
        vehicles = {name: replace(one, shared=shared) for name, one in self.vehicles.items()}
        return replace(self, vehicles=vehicles, shared=shared)

    def resolved_yaml(self, directory: Path | None = None) -> str:
        """The scenario with every default and override written out, as `Loaded.resolved_yaml`."""
        if directory is None:
            return fleet_to_yaml(self.scenario)
        here = {name: seen_from(scenario, directory) for name, scenario in self.scenario.vehicles.items()}
        return fleet_to_yaml(replace(self.scenario, vehicles=here))

    @property
    def whole(self) -> Loaded:
        """The first vehicle, with places in the file as they are."""
        return Loaded(self.scenario.first, self.text, self.path, self.overrides, self.document)

    def mistake(self, path: str | Location, message: str, because: str = "") -> str:
        """A mistake in what is said of all, found after loading, as `Loaded.mistake`."""
        return self.whole.mistake(path, message, because)


AnyLoaded = Loaded | LoadedFleet


def load_any(path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> AnyLoaded:
    """Read and validate a scenario file, of one vehicle or of several.

    Args:
        path: the YAML file.
        overrides: as for `cube_sim.scenario.load`.

    Raises:
        ScenarioError: with one ``file:line:column: path: message`` per mistake.
    """
    path = Path(path)
    return any_from(path, read_text(path), overrides)


def any_from(path: Path, text: str, overrides: Mapping[str, Any] | None = None) -> AnyLoaded:
    """The same of the text of a file."""
    whole = merged(path, parsed(path, text))
    document, bases = whole
    if not names_several(apply(document.data, overrides or {})[0]):
        return loaded_from(path, text, whole, overrides)
    return _fleet(path, text, document, bases, overrides or {})


def any_again(loaded: AnyLoaded, overrides: Mapping[str, Any]) -> AnyLoaded:
    """A loaded scenario with more values replaced, as `loaded_again`, of one vehicle or of several."""
    if isinstance(loaded, Loaded):
        return loaded_again(loaded, overrides)
    before = {override.path: override.value for override in loaded.overrides}
    merged_overrides = {**before, **overrides}
    return _fleet(loaded.path, loaded.text, loaded.document, loaded.bases, merged_overrides, loaded.shared)


def _fleet(
    path: Path,
    text: str,
    document: Document,
    bases: Mapping[str, str],
    overrides: Mapping[str, Any],
    shared: Shared | None = None,
) -> LoadedFleet:
    """The scenario of several vehicles that a parsed file and overrides make."""
    data, applied, wrong_paths = apply(document.data, overrides)
    fleet, refusals, found = _made(data, path.parent)
    if fleet is not None:
        resolved = fleet.as_data()
        refusals += sample_refusals(data, fleet, resolved, lambda varied: _made(varied, path.parent)[1])
    lines = refused_lines(path, document, applied, _once(refusals)) + wrong_paths
    if lines or fleet is None:
        raise ScenarioError(lines)
    loaded = {
        share.name: Loaded(
            fleet.vehicles[share.name], text, path, tuple(applied), document, bases, within=share.place, shared=shared
        )
        for share in found
    }
    return LoadedFleet(fleet, loaded, text, path, tuple(applied), document, bases, shared)


def _made(data: dict[str, Any], directory: Path) -> tuple[FleetScenario | None, list[Refusal], list[Share]]:
    """The scenario of several vehicles that data are, what is wrong with them, and what they say of each vehicle."""
    found, refusals = shares(data)
    scenarios: dict[str, Scenario] = {}
    for share in found:
        scenario, wrong = validated(share.data, directory, several=True)
        refusals += [
            refusal._replace(
                location=share.place(refusal.location),
                because=share.place(refusal.because) if refusal.because else (),
            )
            for refusal in wrong
        ]
        if scenario is not None:
            scenarios[share.name] = scenario
    world, together, wrong = _world(data, found, directory) if found else (None, None, [])
    refusals = [*refusals, *wrong]
    if refusals or world is None or together is None:
        return None, refusals, found
    return FleetScenario(world, scenarios, together), [], found


def has_own_code(loaded: AnyLoaded) -> bool:
    """Whether a scenario names code of the user's own."""
    each = loaded.vehicles.values() if isinstance(loaded, LoadedFleet) else (loaded,)
    return any(any(python_blocks(one.scenario)) for one in each)


def fleet_of(data: Mapping[str, Any]) -> FleetScenario:
    """The scenario of several vehicles that a resolved file holds; names of files in it are not looked at.

    Raises:
        ScenarioError: it holds none that this version knows; with one line.
    """
    found, refusals = shares(data)
    scenarios: dict[str, Scenario] = {}
    for share in found:
        scenario, wrong = validated(share.data, None, several=True)
        refusals += wrong
        if scenario is not None:
            scenarios[share.name] = scenario
    world, together, wrong = _world(data, found, None)
    if world is None or together is None or refusals or wrong:
        first = (*refusals, *wrong)[0]
        raise ScenarioError([f"{'.'.join(map(str, first.location))}: {first.message}"])
    return FleetScenario(world, scenarios, together)


def _world(
    data: Mapping[str, Any], found: Sequence[Share], directory: Path | None
) -> tuple[WorldBlock | None, Scenario | None, list[Refusal]]:
    """What is said of all and asked of several, and what is wrong with it but for what is wrong with each vehicle."""
    keys = [key for key in WorldBlock.model_fields if key in data]
    try:
        context = None if directory is None else {"directory": directory}
        world = WorldBlock.model_validate({key: data[key] for key in keys}, context=context)
    except ValidationError as error:
        return None, None, explain(error, WorldBlock)
    names = [share.name for share in found]
    wrong = [
        Refusal(("checks", i, "between", j), f"no vehicle '{name}'; there are {among(name, names)}", at_key=False)
        for i, check in enumerate(world.checks)
        for j, name in enumerate(getattr(check, "between", ()))
        if name not in names
    ]
    several = any(data_of_checks for share in found if (data_of_checks := share.own.get("checks")))
    if not world.checks and not several:
        text = "a run without checks shows nothing: give at least one, here or to a vehicle"
        wrong.append(Refusal((VEHICLES,), text, at_key=True))
    if wrong:
        return world, None, wrong
    together, refused = validated(together_data(data, world, found), None, several=True)
    return world, together, [refusal for refusal in refused if refusal.location[:1] in (("checks",), ("events",))]


def _once(refusals: Sequence[Refusal]) -> list[Refusal]:
    """Those of what holds for all vehicles, told of each of them, are told once."""
    known: dict[tuple[Location, str], Refusal] = {}
    for refusal in refusals:
        known.setdefault((refusal.location, refusal.message), refusal)
    return list(known.values())
