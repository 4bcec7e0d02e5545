"""Where in an MJCF file, and in those it includes, an element stands that something is wrong with."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple
from xml.parsers import expat

from cube_sim.errors import ModelError

_OF_ACTUATORS, _NUMBERS = "actuator", ("numeric", "text")
_LINE = re.compile(r",? line (\d+)\s*$")
_TAG, _NAME = re.compile(r"Element '([^']*)'|\bin (\w+) Element name"), re.compile(r"Element name '([^']*)'")
_QUOTED = re.compile(r"'([^']*)'")
_NUMBERED = re.compile(r"actuator (\d+)")
_SETTINGS = {"option": "option", "tendon": "tendon", "custom": "custom"}
"""What is named after its own tag."""


class Place(NamedTuple):
    """An element of an XML file.

    Attributes:
        tag: its own.
        around: tag of the element that it stands in.
        attributes: as written.
        file: which has it.
        line: of its beginning, from 1.
        column: likewise.
    """

    tag: str
    around: str
    attributes: dict[str, str]
    file: str
    line: int
    column: int

    def __str__(self) -> str:
        """As compilers say it."""
        return f"{self.file}:{self.line}:{self.column}"


def place_of(path: Path, element: str) -> Place | None:
    """Where what a `ModelError` names stands; None where the files do not say, as of what was attached.

    What is missing is looked for where it would have to be: a number of a hull or thruster at that, one of the water at
    the other custom numbers. What belongs to nothing at all is the whole file's.

    Args:
        path: of the model.
        element: its name, as `ModelError.element` has it; "" for the whole.
    """
    try:
        found = [*elements_of(path)]
    except (OSError, expat.ExpatError):
        return None
    owner, colon, _ = element.rpartition(":")
    numbered = _NUMBERED.fullmatch(element)
    if numbered is not None:
        actuators = [place for place in found if place.around == _OF_ACTUATORS]
        return actuators[int(numbered[1])] if int(numbered[1]) < len(actuators) else None
    if element in _SETTINGS:
        tries: list[Callable[[Place], bool]] = [lambda place: place.tag == _SETTINGS[element]]
    else:
        tries = [
            lambda place: place.tag in ("numeric", "text") and _is_called(place, element),
            *_things_called(element),
        ]
        tries += _things_called(owner) if colon else []
        tries += [lambda place: place.tag == "custom"] if owner == "water" else []
    for fits in (*tries, lambda place: place.tag == "mujoco"):
        place = next((place for place in found if fits(place)), None)
        if place is not None:
            return place
    return None


def at_its_place(error: ModelError, path: Path) -> ModelError:
    """An error about a model that was read from a file, with the place in it where none is told yet.

    Args:
        error: of the model.
        path: of the file.
    """
    if error.place or error.model:
        return error
    place = place_of(path, error.element)
    return ModelError(error.element, error.reason, str(path), "" if place is None else str(place))


def _is_called(place: Place, name: str) -> bool:
    return place.attributes.get("name") == name


def _things_called(name: str) -> list[Callable[[Place], bool]]:
    """Tests for what may have a name, of which several things can have the same: actuators come first, then bodies."""
    return [
        lambda place: place.around == _OF_ACTUATORS and _is_called(place, name),
        lambda place: place.tag == "body" and _is_called(place, name),
        lambda place: place.tag not in _NUMBERS and _is_called(place, name),
    ]


def place_in_words(path: Path, words: str) -> tuple[str, str]:
    """MuJoCo's own words about a file: (file:line:column, the words without it); the file alone where none is known.

    MuJoCo says the line in the file that was asked for, 0 for what an included one holds, and no column.
    """
    line = _LINE.search(words)
    try:
        found = [*elements_of(path)]
    except expat.ExpatError as error:
        return f"{_broken(path)}:{error.lineno}:{error.offset + 1}", expat.errors.messages[error.code]
    except OSError:
        return str(path), words
    rest = words if line is None else words[: line.start()]
    number, tag, name = 0 if line is None else int(line[1]), _TAG.search(words), _NAME.search(words)
    quoted = set(_QUOTED.findall(words[: tag.start()] if tag else ""))
    candidates = [place for place in found if tag is None or place.tag == (tag[1] or tag[2])]
    if name is not None and name[1]:
        candidates = [place for place in candidates if place.attributes.get("name") == name[1]]
    there = [place for place in candidates if number and place.line == number]
    speaking = [place for place in candidates if quoted & {*place.attributes, *place.attributes.values()}]
    if "repeated" in words:
        speaking = speaking[-1:]
    best = [place for place in there if place in speaking] or there or speaking
    if not best and not number and len(candidates) == 1:
        best = candidates
    best += [place for place in found if place.tag == "mujoco"]
    return (str(best[0]), rest) if best else (str(path), rest)


def elements_of(path: Path, main: Path | None = None) -> Iterator[Place]:
    """Every element of a file and of those it includes, in their order.

    Args:
        path: of the file.
        main: folder that names of included files are seen from; None: that of the file.

    Raises:
        OSError: a file is not there.
        ExpatError: one is no XML.
    """
    folder, found, around = main or path.parent, list[Place](), list[str]()
    parser = expat.ParserCreate()

    def begin(tag: str, attributes: dict[str, str]) -> None:
        line, column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        found.append(Place(tag, around[-1] if around else "", dict(attributes), str(path), line, column))
        around.append(tag)

    def end(tag: str) -> None:
        around.pop()

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.Parse(_as_utf8(path.read_bytes()), True)
    for place in found:
        yield place
        file = place.attributes.get("file")
        if place.tag == "include" and file and Path(folder, file).is_file():
            yield from elements_of(Path(folder, file), folder)


def _as_utf8(content: bytes) -> bytes:
    """MuJoCo reads any bytes; an accent of another encoding is worth no refusal."""
    try:
        content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1").encode()
    return content


def _broken(path: Path) -> str:
    """The first of the files that is no XML: the last that parsing went into."""
    parser, included = expat.ParserCreate(), list[str]()

    def begin(tag: str, attributes: dict[str, str]) -> None:
        if tag == "include" and "file" in attributes:
            included.append(attributes["file"])

    parser.StartElementHandler = begin
    try:
        parser.Parse(_as_utf8(path.read_bytes()), True)
    except (OSError, expat.ExpatError):
        return str(path)
    return next((broken for file in included if (broken := _broken_below(Path(path.parent, file)))), str(path))


def _broken_below(path: Path) -> str:
    try:
        list(elements_of(path))
    except expat.ExpatError:
        return _broken(path)
    except OSError:
        return ""
    return ""
