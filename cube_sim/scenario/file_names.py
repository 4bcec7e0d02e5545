"""Keys whose value names a file: what they take, and how all of them are renamed at once.

A key that names a file has the type `ModelFile` or `TableFile`, or another that is marked with a `FileKind`. By that
mark `renamed` finds them all, so that a run and its files can be carried elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import AfterValidator, Field
from pydantic.fields import FieldInfo
from pydantic_core.core_schema import ValidationInfo

from cube_sim.scenario.values import Block, refuse

AnyBlock = TypeVar("AnyBlock", bound=Block)


class FileKind(Enum):
    """What a file that a key names holds: the mark of the key, as metadata of its type."""

    MODEL = "MJCF"
    TABLE = "CSV"


def _beside_the_scenario(file: str, info: ValidationInfo) -> str:
    """The absolute name of a file given relative to the scenario file."""
    if "\0" in file:
        refuse("a file name cannot hold a NUL character")
    return file if info.context is None else str(Path(info.context["directory"], file).resolve())


def _existing_model(file: str, info: ValidationInfo) -> str:
    """The same of an MJCF file, which is there."""
    absolute = _beside_the_scenario(file, info)
    if info.context is None:
        return file
    path = Path(info.context["directory"], file)
    if path.is_dir():
        refuse(f"{file} is a folder, not an MJCF file")
    if not path.is_file():
        refuse(f"no such file: {path}")
    return absolute


ModelFile = Annotated[str, Field(min_length=1), AfterValidator(_existing_model), FileKind.MODEL]
TableFile = Annotated[str, Field(min_length=1), AfterValidator(_beside_the_scenario), FileKind.TABLE]


def file_kind(field: FieldInfo) -> FileKind | None:
    """What the file holds whose name is the value of a key; None for a key that names no file."""
    return next((mark for mark in (*field.metadata, *_marks(field.annotation)) if isinstance(mark, FileKind)), None)


def _marks(annotation: Any) -> Iterator[Any]:
    for inner in get_args(annotation):
        yield inner
        yield from _marks(inner)


def renamed(block: AnyBlock, rename: Callable[[str], str]) -> AnyBlock:
    """The same block, and the blocks in it, with every name of a file replaced by what `rename` makes of it."""
    return block.model_copy(
        update={
            key: _renamed(getattr(block, key), file_kind(field) is not None, rename)
            for key, field in type(block).model_fields.items()
        }
    )


def _renamed(value: Any, is_file: bool, rename: Callable[[str], str]) -> Any:
    if isinstance(value, Block):
        return renamed(value, rename)
    if isinstance(value, tuple):
        return tuple(_renamed(item, is_file, rename) for item in value)
    return rename(value) if is_file and isinstance(value, str) else value
