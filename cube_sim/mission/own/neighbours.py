"""Files beside a file of the user's own that it imports: found while it is loaded, and named for the record."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import ModuleType

from cube_sim.mission.own.imports import imports_of


def neighbours_of(file: Path) -> dict[str, Path]:
    """Files of Python in a file's folder that it imports, or that these do: name seen from the folder -> file.

    An import is seen where it stands in the text; of a package all its files count.
    """
    found: dict[str, Path] = {}
    waiting = [file]
    while waiting:
        for name in sorted(_imported(waiting.pop())):
            package = file.parent / name
            ours = (
                sorted(package.rglob("*.py")) if (package / "__init__.py").is_file() else [package.with_suffix(".py")]
            )
            for each in ours:
                key = each.relative_to(file.parent).as_posix()
                if each.is_file() and each != file and key not in found:
                    found[key] = each
                    waiting.append(each)
    return dict(sorted(found.items()))


_texts: dict[str, bytes] = {}
"""What stood in a neighbour's file when it was imported here, by file."""


@contextmanager
def importable(file: Path) -> Iterator[None]:
    """While this lasts, what stands beside a file is found first, as it is by a program in that folder.

    A module of the same name from elsewhere is out of the way meanwhile. A neighbour whose text has changed since is
    imported anew.
    """
    folder, names = file.parent, {key.removesuffix(".py").split("/")[0] for key in neighbours_of(file)}
    loaded = {key: module for key, module in sys.modules.items() if key.split(".")[0] in names}
    foreign = {key: module for key, module in loaded.items() if not _stands_in(module, folder)}
    changed = [key for key, module in loaded.items() if key not in foreign and _has_changed(module)]
    for key in [*foreign, *changed]:
        del sys.modules[key]
    before = set(sys.modules)
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    try:
        yield
    finally:
        with suppress(ValueError):
            sys.path.remove(str(folder))
        for key in [key for key in sys.modules if key not in before and key.split(".")[0] in names]:
            if (place := getattr(sys.modules[key], "__file__", None)) is not None:
                _texts[place] = Path(place).read_bytes()
            if key.split(".")[0] in {other.split(".")[0] for other in foreign}:
                del sys.modules[key]
        sys.modules.update(foreign)


def _stands_in(module: object, folder: Path) -> bool:
    place = getattr(module, "__file__", None)
    return place is not None and Path(place).is_relative_to(folder)


def _has_changed(module: ModuleType) -> bool:
    place = module.__file__ or ""
    return place in _texts and (not Path(place).is_file() or Path(place).read_bytes() != _texts[place])


def _imported(file: Path) -> set[str]:
    """The first names of what a file imports, but for cube_sim."""
    try:
        names = imports_of(file.read_bytes()).names
    except OSError:
        return set()
    return {name.split(".")[0] for name in names} - {"cube_sim"}
