"""The files of this package that a module is made of: its own and those it imports, to any depth.

Machine code on disk is named by a digest of them. So an edit of any of these files is compiled anew, and nobody keeps
a list.

The files are searched as text. To parse those of the water's callbacks would take a quarter of a warm start, and to
import them would load numba.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path

PACKAGE = Path(__file__).parents[1]

_FROM = re.compile(r"^[ \t]*from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|.*)", re.MULTILINE)
_IMPORT = re.compile(r"^[ \t]*import[ \t]+(.*)", re.MULTILINE)
_NEVER_RUN = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+.*\n|\n)*", re.MULTILINE)


def source_digest(module: str, package: Path = PACKAGE) -> str:
    """Digest of the names and contents of `source_files`; arguments and errors as there."""
    digest = hashlib.sha256()
    for file in source_files(module, package):
        content = file.read_bytes()
        digest.update(f"{file.relative_to(package).as_posix()} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()


def source_files(module: str, package: Path = PACKAGE) -> list[Path]:
    """Files of the package that importing a module runs, sorted by module.

    Imports inside functions count, those for the type checker alone do not. The ``__init__.py`` of every package on
    the way is there too. Relative imports are not seen; this package has none.

    Args:
        module: full name, e.g. ``cube_sim.vehicle.plugin.callbacks``.
        package: folder of the package's sources.

    Raises:
        ModuleNotFoundError: no file of the package holds the module.
    """
    names: list[str] = [module]
    found: dict[str, Path | None] = {}
    for name in names:  # grows on the way
        for part in accumulate(name.split("."), "{}.{}".format):
            if part in found:
                continue
            found[part] = file = _file(part, package)
            if file is not None:
                names += _imported(file.read_text(encoding="utf-8"))
    if found[module] is None:
        raise ModuleNotFoundError(f"no file of {package} holds {module}", name=module)
    return [file for _, file in sorted(found.items()) if file is not None]


def _file(name: str, package: Path) -> Path | None:
    """The file of a module; None where the name is not a module of the package."""
    root, *parts = name.split(".")
    if root != package.name:
        return None
    path = package.joinpath(*parts)
    candidates = path / "__init__.py", path.with_name(f"{path.name}.py")
    return next((file for file in candidates if file.is_file()), None)


def _imported(text: str) -> Iterator[str]:
    """Every name an import statement may mean as a module: after ``from a import b`` both a and a.b."""
    text = _NEVER_RUN.sub("", text)
    for module, names in _FROM.findall(text):
        yield module
        yield from (f"{module}.{name}" for name in re.findall(r"\w+", names))
    for names in _IMPORT.findall(text):
        yield from (name.split()[0] for name in names.split(",") if name.strip())
