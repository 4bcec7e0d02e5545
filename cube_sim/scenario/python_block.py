"""Keys that name Python of the user's own: a law, an allocator, a path, an attitude, a motion law."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from cube_sim.scenario.file_names import CodeName
from cube_sim.scenario.values import Block

PYTHON = "Function or class that makes it: file.py:name, relative to the scenario file, or package.module:name."
OPTIONS = "Keyword arguments of that function, beside what the simulation gives it."

Options = dict[str, Any]


class PythonBlock(Block):
    """A function or class of one's own in place of one that cube_sim has; see docs/extending.md."""

    python: CodeName = Field(description=PYTHON)
    options: Options = Field(default={}, description=OPTIONS)


def _named_or_own(value: Any) -> str:
    return "own" if isinstance(value, dict | PythonBlock) else "name"


NAMED_OR_OWN = Discriminator(_named_or_own)
"""Tells the tags `NAME` and `OWN` apart: one of cube_sim's own, by name, or a `PythonBlock`."""
NAME, OWN = Tag("name"), Tag("own")
OwnPython = Annotated[PythonBlock, OWN]


def python_blocks(block: Block, path: str = "") -> Iterator[tuple[str, PythonBlock]]:
    """(dotted path, block) of all code that a block names, at any depth."""
    for key in type(block).model_fields:
        value, here = getattr(block, key), f"{path}.{key}" if path else key
        if isinstance(value, PythonBlock):
            yield here, value
        elif isinstance(value, Block):
            yield from python_blocks(value, here)
        elif isinstance(value, tuple):
            for index, item in enumerate(value):
                if isinstance(item, PythonBlock):
                    yield f"{here}.{index}", item
