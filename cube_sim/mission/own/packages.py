"""Modules of the user's own that go by their dotted names: taken into the record, and found there again.

A record keeps them under `MODULES`, each where its name says; a package whose folder has no `__init__.py` gets an empty
one, so that nothing of the same name elsewhere joins it.
"""

from __future__ import annotations

import importlib
import importlib.util
import site
import sys
import sysconfig
from collections.abc import Sequence
from functools import cache
from importlib.abc import MetaPathFinder
from importlib.machinery import BYTECODE_SUFFIXES, EXTENSION_SUFFIXES, ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from cube_sim.mission.own.imports import imports_of

MODULES = "python/modules"
"""Folder beside the scenario in which a record lays modules down."""
INIT = "__init__.py"


class Modules(NamedTuple):
    """What a module needs to be imported where nothing else of the user's lies.

    Attributes:
        texts: contents of files of Python, its own among them, by name below `MODULES`.
        not_taken: why that is not all of it; "" where it is.
    """

    texts: dict[str, bytes]
    not_taken: str


def modules_of(name: str) -> Modules:
    """A module, the packages it stands in, and what these import that is neither installed, Python's nor cube_sim's.

    Args:
        name: dotted, of a module that has been imported. What it names may itself be installed.
    """
    own = name.split(".")[0]
    if _has_a_version(own):
        return Modules({}, "")
    texts: dict[str, bytes] = {}
    missing: list[str] = []
    seen: set[str] = set()
    waiting = [name]
    while waiting:
        parts = waiting.pop().split(".")
        folders = _folders(parts[0], parts[0] == own)
        for depth in range(1, len(parts) + 1):
            dotted = ".".join(parts[:depth])
            place = _place(folders, parts[depth - 1])
            if place is None:
                if name == dotted or name.startswith(f"{dotted}."):
                    missing.append(f"the text of {dotted} stands in no file")
                break
            # What a folder without __init__.py holds, it holds wherever it lies.
            folders = [place.parent] if place.name == INIT else _inside(folders, parts[depth - 1])
            if dotted in seen:
                continue
            seen.add(dotted)
            if place.suffix != ".py" and not place.is_dir():
                missing.append(f"{dotted} is no text of Python: {place.name}")
                break
            is_package = place.is_dir() or place.name == INIT
            path = "/".join(parts[:depth])
            text = b"" if place.is_dir() else place.read_bytes()
            texts[f"{path}/{INIT}" if is_package else f"{path}.py"] = text
            found = imports_of(text, dotted if is_package else dotted.rpartition(".")[0])
            waiting += sorted(found.names)
            missing += [f"{dotted} imports in line {line} what its text does not name" for line in found.hidden]
    return Modules(dict(sorted(texts.items())), "; ".join(missing[:1]))


def recorded_modules(folder: Path, name: str) -> Path | None:
    """The folder beside a scenario in which a record has laid down a module; None where it has not."""
    root = folder / MODULES
    place = root.joinpath(*name.split("."))
    return root if place.with_suffix(".py").is_file() or (place / INIT).is_file() else None


class _Recorded(MetaPathFinder):
    """Finds the modules of one folder, whatever else of their names there is.

    Args:
        root: the folder.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.names = {each.name.removesuffix(".py") for each in root.iterdir()}
        self.aside = _withdrawn(self.names)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """See `MetaPathFinder.find_spec`."""
        if path is not None or fullname not in self.names:
            return None
        return PathFinder.find_spec(fullname, [str(self.root)], target)


_standing: list[_Recorded] = []
"""The one whose modules are found now, if any."""


def import_from(root: Path | None) -> None:
    """Find modules in a folder that a record has laid down from now on; None: as if there had never been one.

    What was imported under their names before is out of the way meanwhile.
    """
    if _standing and _standing[0].root == root:
        return
    if _standing:
        recorded = _standing.pop()
        sys.meta_path.remove(recorded)
        _withdrawn(recorded.names)
        sys.modules.update(recorded.aside)
    if root is not None:
        importlib.invalidate_caches()
        _standing.append(_Recorded(root))
        sys.meta_path.insert(0, _standing[0])


def _withdrawn(names: set[str]) -> dict[str, ModuleType]:
    return {key: sys.modules.pop(key) for key in list(sys.modules) if key.split(".")[0] in names}


def _has_a_version(first: str) -> bool:
    """Whether a module is Python's or cube_sim's, of which a record names the version."""
    return first in sys.stdlib_module_names or first == "cube_sim"


def _folders(first: str, named: bool) -> list[Path]:
    """Folders in which a module of the user's own stands; none for any other, and where it cannot be found."""
    if _has_a_version(first):
        return []
    try:
        spec = importlib.util.find_spec(first)
    except (ImportError, ValueError, AttributeError):
        spec = None
    if spec is None:
        return []
    if spec.submodule_search_locations is not None:
        places = [Path(each).parent for each in spec.submodule_search_locations]
    else:
        places = [Path(spec.origin).parent] if spec.has_location and spec.origin else []
    return places if named else [each for each in places if not _is_installed(each)]


@cache
def _installed() -> tuple[Path, ...]:
    names = "purelib", "platlib", "stdlib", "platstdlib"
    places = [*map(sysconfig.get_path, names), *site.getsitepackages(), site.getusersitepackages()]
    return tuple(Path(each).resolve() for each in places)


def _is_installed(folder: Path) -> bool:
    return any(folder.resolve().is_relative_to(each) for each in _installed())


def _place(folders: list[Path], name: str) -> Path | None:
    """The file of a module as Python would choose it, or the folder of a package without `__init__.py`."""
    for folder in folders:
        if (folder / name / INIT).is_file():
            return folder / name / INIT
        for suffix in (*EXTENSION_SUFFIXES, ".py", *BYTECODE_SUFFIXES):
            if (file := folder / f"{name}{suffix}").is_file():
                return file
    return next(iter(_inside(folders, name)), None)


def _inside(folders: list[Path], name: str) -> list[Path]:
    return [folder / name for folder in folders if (folder / name).is_dir()]
