"""`include`: a scenario file that says only what is other than in a base file.

The keys of the including file take the place of the base's, blocks being merged key by key. A list is replaced as a
whole, and so is a block that says by its telling key (`type`, `mode`...) that it is another kind of block. Who says
where to go, by a path, phases or waypoints, says it in place of all that the base says of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, get_args

from cube_sim.errors import ScenarioError
from cube_sim.scenario.document import Document, Location, Mistake, Position
from cube_sim.scenario.file_names import FileKind, code_place, file_kind, looked_up, not_looked_up
from cube_sim.scenario.reading import NoScenarioError, line, parsed, read_text
from cube_sim.scenario.schema import Scenario
from cube_sim.scenario.values import Block

INCLUDE = "include"
VEHICLES = "vehicles"
"""Holds a block for each vehicle, where there are several."""
TELLING = "type", "mode", "kind", "python"
"""Keys that say which kind of block theirs is; others belong to that kind."""

WHERE_TO: tuple[str, ...] = "path", "phases", "waypoints"
"""Ways to say where a vehicle goes."""


class Merged(NamedTuple):
    """A file with all that it includes.

    Attributes:
        document: as if one file held it all; without the key `include`. Positions say which file holds them.
        bases: text of each file that is included, under a name that depends on no machine.
    """

    document: Document
    bases: dict[str, str]


def merged(path: Path, document: Document) -> Merged:
    """A file's document with those of the files that it includes.

    Args:
        path: of the file.
        document: of the file.

    Raises:
        ScenarioError: a file that is included cannot be read, is no scenario or includes itself; with the place.
    """
    bases: dict[str, str] = {}
    seen = [path.resolve()]
    here, whole = path, document
    while isinstance(whole.data, dict) and whole.data.get(INCLUDE) is not None:
        # What includes, for mistakes; the name is seen from the folder of the file that holds it.
        position, name = whole.position((INCLUDE,)), whole.data[INCLUDE]
        base = _base(path, position, name, here, seen)
        text, below = _read(path, position, base)
        bases[f"{INCLUDE}/{len(bases) + 1}/{base.name}"] = text
        below = _at(below, base)
        whole = _merge(_without_include(whole), replace(below, data=_seen_from(below.data, base.parent)))
        seen.append(base.resolve())
        here = base
    return Merged(whole, bases)


def _read(path: Path, position: Position, base: Path) -> tuple[str, Document]:
    """Text and document of a base; where it is no scenario at all, the mistake is that it is named."""
    try:
        text = read_text(base)
        document = parsed(base, text)
    except NoScenarioError as error:
        raise _refused(path, position, str(error)) from None
    return text, document


def _refused(path: Path, position: Position, message: str) -> ScenarioError:
    return ScenarioError([line(path, Mistake(position, (INCLUDE,), message))])


def _base(path: Path, position: Position, name: Any, here: Path, seen: list[Path]) -> Path:
    def refused(message: str) -> ScenarioError:
        return _refused(path, position, message)

    if not isinstance(name, str) or not name or "\0" in name:
        raise refused("must be the name of a scenario file, for example base.yaml")
    base = here.parent / name
    try:
        absolute = looked_up(base)
    except OSError as error:
        raise refused(not_looked_up(name, error)) from None
    if not absolute.exists():
        raise refused(f"no such file: {base}")
    if absolute in seen:
        way = " includes ".join(file.name for file in [*seen[seen.index(absolute) :], base])
        raise refused(f"includes itself: {way}")
    return base


def _at(document: Document, file: Path) -> Document:
    """The same document, its positions saying the file."""

    def placed(position: Position | None) -> Position | None:
        return None if position is None else position._replace(file=str(file))

    return Document(
        document.data,
        tuple(mistake._replace(position=placed(mistake.position)) for mistake in document.mistakes),
        {location: position._replace(file=str(file)) for location, position in document.keys.items()},
        {location: position._replace(file=str(file)) for location, position in document.values.items()},
    )


def _without_include(document: Document) -> Document:
    data = {key: value for key, value in document.data.items() if key != INCLUDE}
    return replace(document, data=data)


def _merge(above: Document, base: Document) -> Document:
    """Two documents as one: what `above` says counts before what `base` says."""
    data, replaced = merged_data(above.data, base.data, ())

    def together(ours: dict[Location, Position], theirs: dict[Location, Position]) -> dict[Location, Position]:
        kept = {
            location: position
            for location, position in theirs.items()
            if not any(location[:length] in replaced for length in range(1, len(location) + 1))
        }
        own = {location: position for location, position in ours.items() if location != (INCLUDE,)}
        # An `include` of the base is looked at next.
        return {**kept, **own}

    mistakes = (*above.mistakes, *base.mistakes)
    return Document(data, mistakes, together(above.keys, base.keys), together(above.values, base.values))


def merged_data(above: Any, base: Any, location: Location = ()) -> tuple[Any, set[Location]]:
    """The data, and where the base's is replaced as a whole."""
    same_kind = isinstance(above, dict) and isinstance(base, dict)
    if not same_kind or any(key in above and above[key] != base.get(key) for key in TELLING):
        return above, {location}
    elsewhere = _goes_elsewhere(above, location)
    data = {key: value for key, value in base.items() if key not in elsewhere}
    replaced = {(*location, key) for key in elsewhere}
    for key, value in above.items():
        if key not in data:
            data[key] = value
            continue
        data[key], inside = merged_data(value, base[key], (*location, key))
        replaced |= inside
    return data, replaced


def _goes_elsewhere(above: dict[str, Any], location: Location) -> set[str]:
    """Keys of a base by which a vehicle does not go where it is told to, as another of these keys says it."""
    of_a_vehicle = location == () or (len(location) == 2 and location[0] == VEHICLES)
    said = {key for key in WHERE_TO if above.get(key) is not None} if of_a_vehicle else set()
    return set(WHERE_TO) - said if said else set()


def _seen_from(data: Any, folder: Path) -> Any:
    """Data of a scenario with the files it names called by absolute names, as seen from a folder."""
    found, here = _named_from(data, (Scenario,), folder.resolve()), folder.resolve()
    if isinstance(data, dict) and isinstance(vehicles := data.get(VEHICLES), dict):
        found[VEHICLES] = {name: _named_from(own, (Scenario,), here) for name, own in vehicles.items()}
    return found


def _named_from(data: Any, blocks: tuple[type[Block], ...], folder: Path) -> Any:
    if isinstance(data, list):
        return [_named_from(item, blocks, folder) for item in data]
    if not isinstance(data, dict):
        return data
    found = {}
    for key, value in data.items():
        fields = [block.model_fields[key] for block in blocks if key in block.model_fields]
        kinds = {kind for field in fields if (kind := file_kind(field)) is not None}
        if kinds and isinstance(value, str):
            found[key] = _absolute(value, folder, FileKind.CODE in kinds)
        else:
            inside = tuple(block for field in fields for block in _blocks(field.annotation))
            found[key] = _named_from(value, inside, folder) if inside else value
    return found


def _absolute(value: str, folder: Path, is_code: bool) -> str:
    if not is_code:
        return str(folder / value)
    place, name = code_place(value)
    return f"{folder / place}:{name}" if place.endswith(".py") else value


def _blocks(annotation: Any) -> Iterator[type[Block]]:
    """Every block that a value of this type may be, or hold in a list."""
    if isinstance(annotation, type) and issubclass(annotation, Block):
        yield annotation
    for inner in get_args(annotation):
        yield from _blocks(inner)
