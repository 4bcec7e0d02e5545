"""Keys whose value names a file: what they take, and how all of them are renamed at once.

A key that names a file has the type `ModelFile`, `TableFile`, `RecordFile` or `CodeName`, or another that is marked
with a `FileKind`. By that mark `renamed` finds them all, so that a run and its files can be carried elsewhere.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import AfterValidator, Field
from pydantic.fields import FieldInfo
from pydantic_core.core_schema import ValidationInfo

from cube_sim.scenario.values import Block, refuse

AnyBlock = TypeVar("AnyBlock", bound=Block)

_SHOWN = 60
"""So many letters of a name that is too long are shown."""


class FileKind(Enum):
    """What a file that a key names holds: the mark of the key, as metadata of its type."""

    MODEL = "MJCF"
    TABLE = "CSV"
    CODE = "Python"
    RECORD = "MCAP"


def looked_up(place: Path) -> Path:
    """Its absolute name, whether there is something or not.

    Raises:
        OSError: the system cannot look: a part of the name is too long, or symbolic links go in a circle.
    """
    try:
        found = place.resolve()
        found.exists()  # names that are too long show only now
    except RuntimeError:  # what pathlib makes of ELOOP
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP)) from None
    return found


def not_looked_up(name: str, error: OSError) -> str:
    """That the system cannot look at a name, in words; of a long one its beginning."""
    return f"{name if len(name) <= _SHOWN else f'{name[:_SHOWN]}...'}: cannot be looked at: {error.strerror}"


def _seen_from(info: ValidationInfo) -> Path | None:
    """The folder from which names of files are seen; None where they are not looked at."""
    return None if info.context is None else info.context.get("directory")


def _beside_the_scenario(file: str, info: ValidationInfo) -> str:
    """The absolute name of a file given relative to the scenario file."""
    if "\0" in file:
        refuse("a file name cannot hold a NUL character")
    directory = _seen_from(info)
    if directory is None:
        return file
    try:
        return str(looked_up(Path(directory, file)))
    except OSError as error:
        refuse(not_looked_up(file, error))


def _existing_model(file: str, info: ValidationInfo) -> str:
    """The same of an MJCF file, which is there."""
    absolute, directory = _beside_the_scenario(file, info), _seen_from(info)
    if directory is None:
        return file
    path = Path(directory, file)
    if path.is_dir():
        refuse(f"{file} is a folder, not an MJCF file")
    if not path.is_file():
        refuse(f"no such file: {path}")
    return absolute


def _existing_record(file: str, info: ValidationInfo) -> str:
    """The absolute name of a run's folder, or of a file in its place."""
    absolute, directory = _beside_the_scenario(file, info), _seen_from(info)
    if directory is not None and not Path(absolute).exists():
        refuse(f"no such file: {Path(directory, file)}")
    return absolute


def code_place(code: str) -> tuple[str, str]:
    """The file, or the dotted module, in which code stands, and its name there."""
    place, _, name = code.rpartition(":")
    return place, name


def _existing_code(code: str, info: ValidationInfo) -> str:
    """Code as file.py:name, the file's name absolute, or as package.module:name."""
    place, name = code_place(code)
    if not name or not (place.endswith(".py") or all(part.isidentifier() for part in place.split("."))):
        refuse(f"must be file.py:name or package.module:name, got {code!r}")
    if not place.endswith(".py"):
        return code
    absolute = _beside_the_scenario(place, info)
    directory = _seen_from(info)
    if directory is not None and not Path(absolute).is_file():
        refuse(f"no such file: {Path(directory, place)}")
    return f"{absolute}:{name}"


ModelFile = Annotated[str, Field(min_length=1), AfterValidator(_existing_model), FileKind.MODEL]
TableFile = Annotated[str, Field(min_length=1), AfterValidator(_beside_the_scenario), FileKind.TABLE]
RecordFile = Annotated[str, Field(min_length=1), AfterValidator(_existing_record), FileKind.RECORD]
CodeName = Annotated[str, Field(min_length=1), AfterValidator(_existing_code), FileKind.CODE]


def file_kind(field: FieldInfo) -> FileKind | None:
    """What the file holds whose name is the value of a key; None for a key that names no file."""
    return next((mark for mark in (*field.metadata, *_marks(field.annotation)) if isinstance(mark, FileKind)), None)


def _marks(annotation: Any) -> Iterator[Any]:
    for inner in get_args(annotation):
        yield inner
        yield from _marks(inner)


def named_files(block: Block, path: str = "") -> Iterator[tuple[str, FileKind, str]]:
    """(dotted path, kind, value) of every key below a block that names a file, in the order of the keys."""
    for key, field in type(block).model_fields.items():
        yield from _named(getattr(block, key), file_kind(field), f"{path}.{key}" if path else key)


def _named(value: Any, kind: FileKind | None, path: str) -> Iterator[tuple[str, FileKind, str]]:
    if isinstance(value, Block):
        yield from named_files(value, path)
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _named(item, kind, f"{path}.{index}")
    elif kind is not None and isinstance(value, str):
        yield path, kind, value


def renamed(block: AnyBlock, rename: Callable[[str], str]) -> AnyBlock:
    """The same block, and the blocks in it, with every name of a file replaced by what `rename` makes of it."""
    return block.model_copy(
        update={
            key: _renamed(getattr(block, key), file_kind(field), rename)
            for key, field in type(block).model_fields.items()
        }
    )


def _renamed(value: Any, kind: FileKind | None, rename: Callable[[str], str]) -> Any:
    if isinstance(value, Block):
        return renamed(value, rename)
    if isinstance(value, tuple):
        return tuple(_renamed(item, kind, rename) for item in value)
    if kind is None or not isinstance(value, str):
        return value
    if kind is not FileKind.CODE:
        return rename(value)
    place, name = code_place(value)
    return f"{rename(place)}:{name}" if place.endswith(".py") else value
