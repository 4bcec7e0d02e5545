"""YAML 1.2 text -> a tree of nodes, or the one place that makes it no YAML.

A quote or a bracket that is never closed is found wanting far from where it stands, often at the end of the file: the
mistake is shown where it opens.
"""

from __future__ import annotations

import copy
import re
from functools import lru_cache
from typing import Any, NamedTuple

from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer, MaxDepthExceededError
from ruamel.yaml.error import MarkedYAMLError, StreamMark, StringMark, YAMLError
from ruamel.yaml.events import AliasEvent
from ruamel.yaml.nodes import Node
from ruamel.yaml.reader import ReaderError
from ruamel.yaml.tokens import ScalarToken

DEEPEST = 60
"""Blocks within blocks; far above any scenario."""
_OPENED = {"while parsing a flow sequence": "[", "while parsing a flow mapping": "{"}
_OUTSIDE = ("got ':'", "got '-'", "got '<stream end>'", "got '<document start>'", "got '<document end>'")
"""What is found in a list or block in brackets, on a later line, when its bracket is missing."""
_A_KEY = re.compile(r"""\s*(?:- |["']?[\w.]+["']?:(?:\s|$))""")
_QUOTES = {'"': "double quote", "'": "quote"}


class Position(NamedTuple):
    """A place in a text file; both counts start at 1. `file` is "" for the one that is read."""

    line: int
    column: int
    file: str = ""


class NotYAMLError(Exception):
    """A text is no YAML.

    Attributes:
        position: where the cause is.
        reason: what is wrong.
    """

    def __init__(self, position: Position, reason: str) -> None:
        self.position, self.reason = position, reason
        super().__init__(reason)


class _AliasesInPlace(Composer):
    """Gives what an alias stands for the place of the alias: that is where a value is used that does not fit."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if not self.parser.check_event(AliasEvent):
            return super().compose_node(parent, index)
        event = self.parser.peek_event()
        node = copy.copy(super().compose_node(parent, index))
        node.start_mark, node.end_mark = event.start_mark, event.end_mark
        return node


@lru_cache(maxsize=8)  # a file is often read again, with other overrides; nobody changes its nodes
def compose(text: str) -> tuple[YAML, Node | None]:
    """The tree of nodes of a text that holds one document, and what made it; no node where there is none.

    Raises:
        NotYAMLError: with the place of the cause.
    """
    yaml = _reader()
    try:
        return yaml, yaml.compose(text)
    except MaxDepthExceededError as error:
        raise NotYAMLError(_of(error.problem_mark), f"nested more than {DEEPEST} deep") from None
    except (YAMLError, ValueError, OverflowError) as error:
        raise _located(text, error) from None


def _reader() -> YAML:
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _AliasesInPlace
    yaml.max_depth = DEEPEST
    yaml.composer.warn_double_anchors = False  # YAML allows it: the last one before an alias counts
    return yaml


def _of(mark: StreamMark | None) -> Position:
    return Position(1, 1) if mark is None else Position(mark.line + 1, mark.column + 1)


def _located(text: str, error: Exception) -> NotYAMLError:
    if text.lstrip().startswith("<"):
        told = "not valid YAML but XML: a scenario is YAML and names its model; cube-sim analyze looks at a model"
        return NotYAMLError(Position(1, 1), told)
    if isinstance(error, ReaderError):
        before = text[: error.position]
        place = Position(before.count("\n") + 1, error.position - before.rfind("\n"))
        shown = f"{text[error.position : error.position + 1]!a}"
        return NotYAMLError(place, f"not text: character {shown} is not allowed in YAML")
    if not isinstance(error, MarkedYAMLError):
        return NotYAMLError(Position(1, 1), f"not valid YAML: {' '.join(str(error).split())}")
    at = error.problem_mark or error.context_mark
    context, problem = " ".join((error.context or "").split()), " ".join((error.problem or "").split())
    opened, quote = _of(error.context_mark), _open_quote(text, at)
    if context == "while scanning a quoted scalar" and error.context_mark is not None:
        return NotYAMLError(opened, "not valid YAML: a quote that opens here is not closed")
    if context == "while scanning a simple key" and error.context_mark is not None:
        return NotYAMLError(opened, "not valid YAML: what begins here is no key: there is no ':' behind it")
    if quote is not None:
        name = _QUOTES[quote.style]
        text = f"a {name} that opens here closes only in line {quote.end_mark.line + 1}, amid other text"
        return NotYAMLError(_of(quote.start_mark), f"not valid YAML: {text}")
    if context in _OPENED and error.context_mark is not None and at is not None:
        bracket = _OPENED[context]
        found = "".join(text.splitlines()[at.line : at.line + 1])
        outside = problem.endswith(_OUTSIDE) or _A_KEY.match(found) is not None
        if at.line > error.context_mark.line and outside:
            return NotYAMLError(opened, f"not valid YAML: a {bracket!r} that opens here is not closed")
        return NotYAMLError(_of(at), f"not valid YAML: {problem}, for the {bracket!r} in column {opened.column}")
    return NotYAMLError(_of(at), f"not valid YAML: {' '.join(part for part in (context, problem) if part)}")


def _open_quote(text: str, at: StringMark | None) -> ScalarToken | None:
    """The quoted scalar before a place, when it runs over several lines and ends in that of the place.

    Such a one may be meant; more likely, a quote is missing in its first line, and the next quote has closed it.
    """
    if at is None:
        return None
    last = None
    try:
        for token in _reader().scan(text):
            if token.start_mark.index > at.index:
                break
            if (
                isinstance(token, ScalarToken)
                and token.style in _QUOTES
                and token.end_mark.line > token.start_mark.line
            ):
                last = token
    except YAMLError:
        pass
    return last if last is not None and last.end_mark.line == at.line else None
