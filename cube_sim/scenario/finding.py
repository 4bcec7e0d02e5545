"""Which files of a folder are scenarios: told by what they hold, not by where they stand or what they are called.

A scenario says ``schema_version`` at its top and, beside it, some of the other keys that every scenario has, or nearly
all of these without it; or it includes a file that is one. That is looked for in the text, so that a scenario with
mistakes in it is still one, and a folder full of other YAML costs little more than reading it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from cube_sim.errors import ScenarioError

SUFFIXES = (".yaml", ".yml")
LARGEST_BYTES = 1_000_000
"""Larger files are no scenarios, see `cube_sim.scenario.reading`."""

_BEFORE, _AFTER = rb"""^[ \t]*[{,]?[ \t]*["']?""", rb"""["']?[ \t]*:"""
_VERSION = re.compile(_BEFORE + b"schema_version" + _AFTER, re.MULTILINE)
_OTHER = re.compile(
    rb"""(?:^|[{,])[ \t]*["']?(name|model|duration_s|path|guidance|checks|vehicles)""" + _AFTER, re.MULTILINE
)
_ENOUGH = 3
"""Of the other keys that every scenario has, so many are there even where some are misspelt or left to a base."""
_WITHOUT_VERSION = 5
_INCLUDE = re.compile(rb"""^[{]?[ \t]*include[ \t]*:[ \t]*["']?([^\s"'#,}\[]+)""", re.MULTILINE)
_MOST_INCLUDES = 20
_OF_A_RUN = ("run.mcap", "verdict.json")
_LEFT_OUT = ("__pycache__", "node_modules", "site-packages", "venv")


class FoundScenarios(NamedTuple):
    """What folders and files hold.

    Attributes:
        scenarios: files to fly, in the order asked for, those of a folder by name; none twice.
        others: YAML files of the folders that are no scenarios.
    """

    scenarios: tuple[Path, ...]
    others: tuple[Path, ...]


def find(places: Iterable[Path]) -> FoundScenarios:
    """The scenarios among files and folders.

    A file that is named is taken for one, whatever is in it. A folder is searched to any depth; left out are hidden
    folders, environments, and the ``resolved.yaml`` in folders of runs.

    Raises:
        ScenarioError: a folder holds none, or cannot be read.
    """
    scenarios: dict[Path, Path] = {}
    others: list[Path] = []
    for place in places:
        if not place.is_dir():
            scenarios.setdefault(place.resolve(), place)
            continue
        there = list(yaml_files(place))
        found = [file for file in there if is_scenario(file)]
        if not found:
            looked = f"of {len(there)} YAML files in it none is one" if there else "there is no YAML file in it"
            raise ScenarioError([f"{place}: holds no scenario: {looked}"])
        for file in found:
            scenarios.setdefault(file.resolve(), file)
        others += [file for file in there if file not in found]
    return FoundScenarios(tuple(scenarios.values()), tuple(others))


def yaml_files(folder: Path) -> Iterator[Path]:
    """The YAML files of a folder, to any depth, by name; but those of runs, environments and hidden folders.

    Raises:
        ScenarioError: it cannot be read.
    """

    def unreadable(error: OSError) -> None:
        raise ScenarioError([f"{error.filename}: cannot be read: {error.strerror}"])

    for here, folders, files in os.walk(folder, onerror=unreadable):
        folders[:] = sorted(name for name in folders if not left_out(name))
        for name in sorted(files):
            if name.endswith(SUFFIXES) and not is_of_a_run(Path(here, name)):
                yield Path(here, name)


def is_of_a_run(file: Path) -> bool:
    """Whether a run has left a file: its scenario written out, beside its record or its verdict."""
    return file.name == "resolved.yaml" and any(file.with_name(name).exists() for name in _OF_A_RUN)


def left_out(folder: str) -> bool:
    """Whether a folder of this name holds nothing of the user's own."""
    return folder.startswith(".") or folder in _LEFT_OUT


def is_scenario(file: Path) -> bool:
    """Whether a YAML file is a scenario, right or wrong; what cannot be read is none."""
    return _is_scenario(file, _MOST_INCLUDES)


def _is_scenario(file: Path, deeper: int) -> bool:
    try:
        if not file.is_file() or file.stat().st_size > LARGEST_BYTES:
            return False
        content = file.read_bytes().removeprefix(b"\xef\xbb\xbf").replace(b"\r", b"\n")
    except OSError:
        return False
    if len(set(_OTHER.findall(content))) >= (_ENOUGH if _VERSION.search(content) else _WITHOUT_VERSION):
        return True
    included = _INCLUDE.search(content)
    if included is None or not deeper:
        return False
    return _is_scenario(file.parent / os.fsdecode(included[1]), deeper - 1)
