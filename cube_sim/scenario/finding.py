"""Which files of a folder are scenarios: told by what they hold, not by where they stand or what they are called.

A scenario says ``schema_version`` at its top and, beside it, some of the other keys that every scenario has, or nearly
all of these without it; some of them may stand in a file that it includes. One that includes what cannot be read, or
itself, is one by any key of a scenario: its mistake is to be told. All that is looked for in the text, so that a
scenario with mistakes in it is still one, and a folder full of other YAML costs little more than reading it.
"""

from __future__ import annotations

import codecs
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from cube_sim.errors import ScenarioError
from cube_sim.scenario.schema import Scenario

SUFFIXES = (".yaml", ".yml")
LARGEST_BYTES = 1_000_000
"""Larger files are no scenarios, see `cube_sim.scenario.reading`."""

_EVERY = frozenset(("name", "model", "duration_s", "path", "guidance", "checks", "vehicles"))
"""Keys that every scenario has, or nearly every."""
_NAMES = "|".join(sorted({*Scenario.model_fields, *_EVERY} - {"include"}, key=len, reverse=True))
_KEY = re.compile(rf"""(?:^|[{{,])[ \t]*["']?({_NAMES})["']?[ \t]*:""", re.MULTILINE)
_AT_THE_TOP = re.compile(rf"""^[{{]?["']?({_NAMES})["']?[ \t]*:""", re.MULTILINE)
_ENOUGH = 3
"""Of the other keys that every scenario has, so many are there even where some are misspelt or left to a base."""
_WITHOUT_VERSION = 5
_INCLUDE = re.compile(
    r"""^[{]?[ \t]*["']?include["']?[ \t]*:\s*(?:"([^"\n]+)"|'([^'\n]+)'|([^\s"'#,{}\[\]-][^#,{}\n]*))""", re.MULTILINE
)
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
    text, keys, told = _text(file), set[str](), False
    for _ in range(_MOST_INCLUDES):
        if text is None:
            break
        keys |= set(_KEY.findall(text))
        if len(keys & _EVERY) >= (_ENOUGH if "schema_version" in keys else _WITHOUT_VERSION):
            return True
        included = _INCLUDE.search(text)
        if included is None:
            return False
        told = told or _AT_THE_TOP.search(text) is not None
        file = file.parent / next(filter(None, included.groups())).strip()
        text = _text(file)
    return told and file.suffix in SUFFIXES


def _text(file: Path) -> str | None:
    """What a file says; None where it cannot be read, or is no scenario by its size."""
    try:
        if not file.is_file() or file.stat().st_size > LARGEST_BYTES:
            return None
        content = file.read_bytes()
    except (OSError, ValueError):
        return None
    encoding = "utf-16" if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8-sig"
    return content.decode(encoding, errors="replace").replace("\r", "\n")
