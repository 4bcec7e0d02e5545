"""YAML 1.2 text -> plain data, with the line and column of every key and value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode

from cube_sim.scenario.composing import NotYAMLError, Position, compose

Location = tuple[str | int, ...]
"""Keys and list indices from the top of the document to a value."""

EMPTY = "the file is empty"
# Far above any scenario; a tower of aliases passes it within a second. What is written out may be longer.
_MOST_COPIES = 20_000
_MERGE = "tag:yaml.org,2002:merge"
NO_MERGE = (
    "merge keys are not part of YAML 1.2; write the keys out, or let the file include one that holds what is shared"
)
_NUMBERS = {"tag:yaml.org,2002:int", "tag:yaml.org,2002:float"}
_PLAIN_TAGS = {"tag:yaml.org,2002:map", "tag:yaml.org,2002:seq"}


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
        yaml, root = compose(text)
    except NotYAMLError as error:
        return Document(None, (Mistake(error.position, (), error.reason),))
    if root is None or root.tag == "tag:yaml.org,2002:null":
        return Document(None, (Mistake(Position(1, 1), (), EMPTY),))
    builder = _Builder(yaml)
    try:
        data = builder.build(root, ())
    except _TooManyError as error:
        return Document(None, (Mistake(error.position, (), f"aliases repeat more than {_MOST_COPIES} values"),))
    return Document(data, tuple(builder.mistakes), builder.keys, builder.values)


def parse_value(text: str) -> Any:
    """Parse one YAML value, as written after `=` in an override.

    Raises:
        ValueError: the text is not one YAML value; the message says why.
    """
    document = parse(text)
    if document.mistakes and document.mistakes[0].message != EMPTY:
        raise ValueError(document.mistakes[0].message)
    return document.data


class _TooManyError(Exception):
    def __init__(self, position: Position) -> None:
        self.position = position


class _Builder:
    """Walks a tree of YAML nodes once, noting positions and mistakes."""

    def __init__(self, yaml: YAML) -> None:
        self.mistakes: list[Mistake] = []
        self.keys: dict[Location, Position] = {}
        self.values: dict[Location, Position] = {}
        self._yaml = yaml
        # By what nodes hold: an alias is a node of its own, with the same in it.
        self._open: list[Any] = []
        self._built: set[int] = set()
        self._copies = 0

    def build(self, node: Node, location: Location) -> Any:
        self.values[location] = _start(node)
        if isinstance(node, ScalarNode):
            return self._scalar(node, location)
        if node.tag not in _PLAIN_TAGS:
            return self._refuse(node, location, f"the tag {node.tag} is not supported")
        # Aliases are followed, so a loop or a tower of them would grow without end.
        if any(node.value is one for one in self._open):
            return self._refuse(node, location, "an alias that contains itself")
        if id(node.value) in self._built:
            self._copies += max(1, len(node.value))
            if self._copies > _MOST_COPIES:
                raise _TooManyError(_start(node))
        self._built.add(id(node.value))
        self._open.append(node.value)
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
            if key_node.tag == _MERGE:
                self._refuse(key_node, here, NO_MERGE)
                self._merge(value_node, data, location)
                continue
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

    def _merge(self, node: Node, data: dict[str, Any], location: Location) -> None:
        """Take over what a merge key would, so that nobody is told of it as missing."""
        before = self.values[location]
        for each in [node] if isinstance(node, MappingNode | ScalarNode) else node.value:
            if isinstance(each, MappingNode):
                found = self.build(each, location)
                data.update({key: value for key, value in (found or {}).items() if key not in data})
        self.values[location] = before

    def _sequence(self, node: Node, location: Location) -> list[Any]:
        items = []
        for index, item in enumerate(node.value):
            here = (*location, index)
            self.keys[here] = _start(item)
            items.append(self.build(item, here))
        return items

    def _scalar(self, node: ScalarNode, location: Location) -> Any:
        if node.tag in _NUMBERS and "_" in node.value:
            return node.value  # a number of YAML 1.1; here it is text
        try:
            return self._yaml.constructor.construct_object(node)
        except (YAMLError, ValueError, OverflowError) as error:
            reason = error.problem if isinstance(error, MarkedYAMLError) else str(error)
            return self._refuse(node, location, f"cannot be read: {reason}")

    def _refuse(self, node: Node, location: Location, message: str) -> None:
        self.mistakes.append(Mistake(_start(node), location, message))


def _start(node: Node) -> Position:
    return Position(node.start_mark.line + 1, node.start_mark.column + 1)
