"""YAML 1.2 text -> plain data, with the line and column of every key and value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode
from ruamel.yaml.reader import ReaderError

Location = tuple[str | int, ...]
"""Keys and list indices from the top of the document to a value."""

_EMPTY = "the file is empty"
# Far above any scenario; a tower of aliases passes it within a second.
_MOST_VALUES = 20_000
_PLAIN_TAGS = {"tag:yaml.org,2002:map", "tag:yaml.org,2002:seq"}


class Position(NamedTuple):
    """A place in a text file; both counts start at 1. `file` is "" for the one that is read."""

    line: int
    column: int
    file: str = ""


class Mistake(NamedTuple):
    """Something wrong at a place of a document.

    Attributes:
        position: where; None when the cause is not in the file.
        location: keys from the top, () for the document itself.
        message: what is wrong and what would be right.
    """

    position: Position | None
    location: Location
    message: str


@dataclass(frozen=True)
class Document:
    """One YAML document.

    Attributes:
        data: dicts, lists and scalars; None when the text could not be parsed or holds nothing.
        mistakes: what the YAML itself gets wrong: syntax, repeated keys, unknown tags.
        keys: position of each key (of each item, in a list).
        values: position of each value.
    """

    data: Any
    mistakes: tuple[Mistake, ...]
    keys: dict[Location, Position] = field(default_factory=dict)
    values: dict[Location, Position] = field(default_factory=dict)

    def position(self, location: Sequence[str | int], *, key: bool = False) -> Position:
        """Where a value (or its key) is written, or the nearest block around it that is."""
        places = self.keys if key else self.values
        for length in range(len(location), 0, -1):
            here = tuple(location[:length])
            if here in self.values:
                # What is missing from a block is shown at the block's key.
                return (places if length == len(location) else self.keys)[here]
        return Position(1, 1)


def parse(text: str) -> Document:
    """Parse one YAML 1.2 document; never raises on bad text."""
    try:
        yaml, root = _composed(text)
    except RecursionError:
        return Document(None, (Mistake(Position(1, 1), (), "nested too deeply"),))
    except YAMLError as error:
        return Document(None, (_syntax_mistake(text, error),))
    if root is None or root.tag == "tag:yaml.org,2002:null":
        return Document(None, (Mistake(Position(1, 1), (), _EMPTY),))
    builder = _Builder(yaml)
    data = builder.build(root, ())
    return Document(data, tuple(builder.mistakes), builder.keys, builder.values)


@lru_cache(maxsize=8)  # a file is often read again, with other overrides; builders only read its nodes
def _composed(text: str) -> tuple[YAML, Node | None]:
    """The tree of nodes of a text, and what made it."""
    yaml = YAML(typ="safe", pure=True)
    return yaml, yaml.compose(text)


def parse_value(text: str) -> Any:
    """Parse one YAML value, as written after `=` in an override.

    Raises:
        ValueError: the text is not one YAML value; the message says why.
    """
    document = parse(text)
    if document.mistakes and document.mistakes[0].message != _EMPTY:
        raise ValueError(document.mistakes[0].message)
    return document.data


def _syntax_mistake(text: str, error: YAMLError) -> Mistake:
    if isinstance(error, MarkedYAMLError):
        mark = error.problem_mark or error.context_mark
        position = Position(mark.line + 1, mark.column + 1) if mark else Position(1, 1)
        reason = " ".join(part for part in (error.context, error.problem) if part)
        return Mistake(position, (), f"not valid YAML: {' '.join(reason.split())}")
    if isinstance(error, ReaderError):
        before = text[: error.position]
        position = Position(before.count("\n") + 1, error.position - before.rfind("\n"))
        return Mistake(
            position,
            (),
            f"not text: character {text[error.position : error.position + 1]!a} is not allowed in YAML",
        )
    return Mistake(Position(1, 1), (), f"not valid YAML: {' '.join(str(error).split())}")


class _Builder:
    """Walks a tree of YAML nodes once, noting positions and mistakes."""

    def __init__(self, yaml: YAML) -> None:
        self.mistakes: list[Mistake] = []
        self.keys: dict[Location, Position] = {}
        self.values: dict[Location, Position] = {}
        self._yaml = yaml
        self._open: list[Node] = []

    def build(self, node: Node, location: Location) -> Any:
        self.values[location] = _start(node)
        if isinstance(node, ScalarNode):
            return self._scalar(node, location)
        if node.tag not in _PLAIN_TAGS:
            return self._refuse(node, location, f"the tag {node.tag} is not supported")
        # Aliases are followed, so a loop or a tower of them would grow without end.
        if node in self._open or len(self.values) > _MOST_VALUES:
            return self._refuse(node, location, "an alias that contains itself or grows without bound")
        self._open.append(node)
        try:
            return self._mapping(node, location) if isinstance(node, MappingNode) else self._sequence(node, location)
        finally:
            self._open.pop()

    def _mapping(self, node: MappingNode, location: Location) -> dict[str, Any]:
        data: dict[str, Any] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, ScalarNode):
                self._refuse(key_node, location, "a key must be a plain word")
                continue
            key = key_node.value
            here = (*location, key)
            if key in data:
                first = self.keys[here].line
                self._refuse(key_node, here, f"the key {key!r} is already given in line {first}")
                continue
            self.keys[here] = _start(key_node)
            data[key] = self.build(value_node, here)
            if value_node.start_mark.index == value_node.end_mark.index:
                # Nothing is written: YAML puts that wherever the next word is, a reader at the key.
                self.values[here] = self.keys[here]
        return data

    def _sequence(self, node: Node, location: Location) -> list[Any]:
        items = []
        for index, item in enumerate(node.value):
            here = (*location, index)
            self.keys[here] = _start(item)
            items.append(self.build(item, here))
        return items

    def _scalar(self, node: ScalarNode, location: Location) -> Any:
        try:
            return self._yaml.constructor.construct_object(node)
        except (YAMLError, ValueError, OverflowError) as error:
            reason = error.problem if isinstance(error, MarkedYAMLError) else str(error)
            return self._refuse(node, location, f"cannot be read: {reason}")

    def _refuse(self, node: Node, location: Location, message: str) -> None:
        self.mistakes.append(Mistake(_start(node), location, message))


def _start(node: Node) -> Position:
    return Position(node.start_mark.line + 1, node.start_mark.column + 1)
