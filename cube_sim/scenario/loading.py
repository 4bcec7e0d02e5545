"""A scenario file, read with every mistake in it found at once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cube_sim.errors import ScenarioError
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.document import Document, Location, Mistake, Position
from cube_sim.scenario.explain import Refusal, explain
from cube_sim.scenario.file_names import renamed
from cube_sim.scenario.include import TELLING, Merged, merged
from cube_sim.scenario.named_signals import signal_mistakes
from cube_sim.scenario.overrides import Override, apply
from cube_sim.scenario.phase_blocks import as_written, with_first_leg
from cube_sim.scenario.possible_samples import sample_refusals
from cube_sim.scenario.reading import CHECKS, dotted, line, parsed, read_text
from cube_sim.scenario.resolved import seen_from, to_yaml
from cube_sim.scenario.schema import Scenario
from cube_sim.scenario.shared import Shared

_KEYS = tuple(Scenario.model_fields)
_ONE_VEHICLE = "here one vehicle is flown at a time; `cube-sim run` and `cube_sim.run` fly several"


@dataclass(frozen=True)
class Loaded:
    """A valid scenario and where it came from.

    Attributes:
        scenario: the frozen scenario; its model path is absolute.
        text: the file as written.
        path: the file, as given.
        overrides: what replaced values of the file.
        document: the file as parsed, with those it includes: where each value is written, for mistakes that are found
            later.
        bases: text of each file it includes, under a name that depends on no machine.
        given: functions, classes and objects that a program hands over, by the key of the block that names them.
        shared: what many flights of variations of it share; None where each makes all anew.
        within: where in the file a value of this scenario stands, of one vehicle among several; None: where it is.
    """

    scenario: Scenario
    text: str
    path: Path
    overrides: tuple[Override, ...]
    document: Document
    bases: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, Any] = field(default_factory=dict)
    shared: Shared | None = field(default=None, compare=False, repr=False)
    within: Callable[[Location], Location] | None = None

    def resolved_yaml(self, directory: Path | None = None) -> str:
        """The scenario with every default and override written out.

        Args:
            directory: the folder the text will stand in, to which the files it names are written relative. None:
                they are absolute, and `load` reads the text from any folder.
        """
        return to_yaml(self.scenario if directory is None else seen_from(self.scenario, directory))

    def mistake(self, path: str | Location, message: str, because: str = "") -> str:
        """A mistake found after loading (the model has no such thruster...), as a line of a ScenarioError.

        Args:
            path: dotted path of the value at fault; its keys, where one has a dot in it.
            message: what is wrong and what would be right.
            because: dotted path of another value which this one does not fit.
        """
        where, why = _location(path) if isinstance(path, str) else path, _location(because)
        if self.within is not None:
            where, why = self.within(where), self.within(why) if why else ()
        place = _place(Refusal(where, message, at_key=False, because=why), self.document, self.overrides)
        return line(self.path, place)


def load(path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> Loaded:
    """Read and validate a scenario file.

    Args:
        path: the YAML file.
        overrides: dotted path -> value that replaces the file's, for example ``{"checks.0.at_most": 0.2}``.

    Raises:
        ScenarioError: with one ``file:line:column: path: message`` per mistake.
    """
    path = Path(path)
    return _load(path, read_text(path), overrides)


def load_mapping(scenario: Mapping[str, Any], overrides: Mapping[str, Any] | None = None) -> Loaded:
    """Validate what would stand in a scenario file; file names in it are seen from the working directory.

    Args:
        scenario: keys and values as in a file: numbers, text, lists and mappings.
        overrides: as for `load`.

    Raises:
        ScenarioError: with one line per mistake; lines and columns are those of the scenario written out as JSON.
    """
    try:
        text = json.dumps(_plain(scenario), indent=2)
    except (TypeError, ValueError) as error:
        raise ScenarioError([f"the scenario cannot be written out: {error}"]) from None
    return _load(Path("scenario.json"), text, overrides)


def loaded_again(loaded: Loaded, overrides: Mapping[str, Any]) -> Loaded:
    """A loaded scenario with more values replaced.

    Args:
        loaded: from which all else is.
        overrides: as for `load`; they come after those it has.

    Raises:
        ScenarioError: with one line per mistake.
    """
    before = {override.path: override.value for override in loaded.overrides}
    scenario, applied = _overridden(loaded.path, loaded.document, {**before, **overrides})
    return replace(loaded, scenario=scenario, overrides=applied)


def _plain(value: Any) -> Any:
    """Arrays, tuples and paths as what a file holds."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, os.PathLike) else value


def load_checks(
    path: str | os.PathLike[str], scenario: Mapping[str, Any], widths: Mapping[str, int], recorded: Collection[str]
) -> tuple[AnyCheck, ...]:
    """Read the checks of a file, of a scenario or of one that holds nothing else, to judge another scenario's run.

    Args:
        path: the YAML file.
        scenario: the scenario that was flown, as its file would hold it.
        widths: signal -> how many numbers a sample has, of those that a check may name.
        recorded: those of them that the run recorded.

    Raises:
        ScenarioError: with one ``file:line:column: path: message`` per mistake.
    """
    path = Path(path)
    document = merged(path, parsed(path, read_text(path, CHECKS), CHECKS)).document
    strange = [Refusal((key,), _no_such_key(str(key)), at_key=True) for key in document.data if key not in _KEYS]
    if strange:
        raise ScenarioError([line(path, _place(refusal, document, ())) for refusal in strange])
    if "checks" not in document.data:
        raise ScenarioError([f"{path}:1:1: checks: is missing; give a list of checks"])
    data = {**scenario, "checks": document.data["checks"]}
    checks = tuple(_beside(path, each) for each in _validated(path, document, data, (), [], None).checks)
    mistakes = signal_mistakes(checks, widths, recorded=recorded)
    refusals = [Refusal(_location(place), text, at_key=False) for place, text in mistakes]
    if refusals:
        raise ScenarioError([line(path, _place(refusal, document, ())) for refusal in refusals])
    return checks


def _beside(path: Path, check: AnyCheck) -> AnyCheck:
    """A check of a file whose own files are seen from it."""
    return renamed(check, lambda file: str(Path(path.parent, file).resolve()))


def _no_such_key(key: str) -> str:
    near = get_close_matches(key, _KEYS, n=1)
    return f"unknown key; did you mean {near[0]}?" if near else "unknown key; known: checks, and those of a scenario"


def _load(path: Path, text: str, overrides: Mapping[str, Any] | None) -> Loaded:
    return loaded_from(path, text, merged(path, parsed(path, text)), overrides)


def loaded_from(path: Path, text: str, whole: Merged, overrides: Mapping[str, Any] | None) -> Loaded:
    """`load` of a file that is parsed already, with all that it includes."""
    scenario, applied = _overridden(path, whole.document, overrides or {})
    return Loaded(scenario, text, path, applied, whole.document, whole.bases)


def _overridden(path: Path, document: Document, overrides: Mapping[str, Any]) -> tuple[Scenario, tuple[Override, ...]]:
    data, applied, wrong_paths = apply(document.data, overrides)
    if "vehicles" in data:
        place = _place(Refusal(("vehicles",), _ONE_VEHICLE, at_key=True), document, applied)
        raise ScenarioError([line(path, place)])
    return _validated(path, document, data, applied, wrong_paths, path.parent), tuple(applied)


def _validated(
    path: Path,
    document: Document,
    data: dict[str, Any],
    applied: Sequence[Override],
    wrong_paths: list[str],
    directory: Path | None,
) -> Scenario:
    """The scenario that a file and its overrides make, files named in it being seen from a folder, or not looked at.

    Raises:
        ScenarioError: with one line per mistake.
    """
    scenario, refusals = validated(data, directory)
    if scenario is not None:
        given = {} if scenario.samples is None else scenario.model_dump()
        refusals = sample_refusals(data, scenario, given, lambda varied: validated(varied, directory)[1])
    lines = refused_lines(path, document, applied, refusals)
    if lines or wrong_paths or scenario is None:
        raise ScenarioError(lines + wrong_paths)
    return scenario


def refused_lines(
    path: Path, document: Document, applied: Sequence[Override], refusals: Sequence[Refusal]
) -> list[str]:
    """What a file, and its overrides, get wrong, a line each, in the order of their places."""
    # Where the YAML itself is wrong, the schema need not say so again.
    reported = {mistake.position for mistake in document.mistakes}
    found = [_place(refusal, document, applied) for refusal in refusals]
    found = [mistake for mistake in found if mistake.position not in reported]
    in_file = sorted([*document.mistakes, *(mistake for mistake in found if mistake.position)], key=_by_position)
    in_overrides = [mistake.message for mistake in found if not mistake.position]
    return [line(path, mistake) for mistake in in_file] + in_overrides


def validated(
    data: dict[str, Any], directory: Path | None, several: bool = False
) -> tuple[Scenario | None, list[Refusal]]:
    """The scenario that data are, and what is wrong with them.

    Args:
        data: as a file holds them, its overrides in place.
        directory: from which the files are seen that it names; None: they are not looked at.
        several: whether it is one of several vehicles, which need not have checks of its own.
    """
    context: dict[str, Any] = {"several": True} if several else {}
    if directory is not None:
        context["directory"] = directory
    try:
        return Scenario.model_validate(with_first_leg(data), context=context or None), []
    except ValidationError as error:
        found = [each._replace(location=as_written(each.location, data)) for each in explain(error, Scenario)]
        # What is wrong with the legs that waypoints stand for is wrong with something else in the file.
        others = [each for each in found if each.location != ("waypoints",)]
        return None, list(dict.fromkeys(others or found))


def _place(refusal: Refusal, document: Document, overrides: Sequence[Override]) -> Mistake:
    """Find who wrote the value at fault: an override (the mistake then has no position) or the file."""
    location = refusal.location
    for override in overrides:
        below = location[: len(override.location)] == override.location
        # An unknown block that exists only because the override's path goes through it.
        above = override.location[: len(location)] == location and refusal.at_key and location not in document.keys
        if below or above:
            inside = "" if location == override.location else f"{dotted(location)}: "
            return Mistake(None, location, f"override {override.path}: {inside}{refusal.message}")
    other_kind = next((override for override in overrides if _makes_another_kind(override, refusal, document)), None)
    if other_kind is not None:
        block = dotted(other_kind.location[:-1])
        told = (
            f"{dotted(location)}: {refusal.message}; another {other_kind.location[-1]} takes the whole block: {block}="
        )
        return Mistake(None, location, f"override {other_kind.path}: {told}{{...}}")
    if refusal.because and location not in document.values:
        # A default that does not fit what is written: there is nothing to show but that.
        where, message = refusal.because, f"{dotted(location)}: {refusal.message}"
        blamed = next((override for override in overrides if override.location == where), None)
        if blamed is not None:
            return Mistake(None, where, f"override {blamed.path}: {message}")
        if where in document.values:
            return Mistake(document.position(where), where, message)
    blame = [f" (override {override.path})" for override in overrides if override.location == refusal.because]
    return Mistake(document.position(location, key=refusal.at_key), location, refusal.message + "".join(blame))


def _makes_another_kind(override: Override, refusal: Refusal, document: Document) -> bool:
    """Whether a key is unknown, or missing, because an override turned its block into one of another kind."""
    *block, key = override.location
    if not block or key not in TELLING or list(refusal.location[: len(block)]) != block:
        return False
    return refusal.at_key or (refusal.location not in document.values and not refusal.because)


def _location(path: str) -> Location:
    return tuple(int(step) if step.isdigit() else step for step in path.split(".") if step)


def _by_position(mistake: Mistake) -> tuple[str, Position]:
    position = mistake.position or Position(0, 0)
    return position.file, position
