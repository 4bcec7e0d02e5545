"""What a text of Python imports, read without running it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from importlib.util import resolve_name
from typing import NamedTuple


class Imports(NamedTuple):
    """What a text imports, wherever in it.

    Attributes:
        names: dotted names of modules; of `from a import b` both a and a.b, which may be a module.
        hidden: lines that import what only running them tells.
    """

    names: frozenset[str]
    hidden: tuple[int, ...]


def imports_of(text: bytes, package: str = "") -> Imports:
    """What a text imports; nothing where it is no Python.

    Args:
        text: as it stands in the file.
        package: in which its module stands, for relative names; "" for none: these are left out.
    """
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return Imports(frozenset(), ())
    names, hidden = set(), []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= set(_taken_from(node, package))
        elif isinstance(node, ast.Call) and _called(node) in ("import_module", "__import__"):
            first = node.args[0] if node.args else None
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                names |= set(_absolute(first.value, package))
            else:
                hidden.append(node.lineno)
    return Imports(frozenset(names), tuple(sorted(hidden)))


def _taken_from(node: ast.ImportFrom, package: str) -> Iterator[str]:
    for module in _absolute("." * node.level + (node.module or ""), package):
        yield module
        yield from (f"{module}.{alias.name}" for alias in node.names if alias.name != "*")


def _absolute(name: str, package: str) -> Iterator[str]:
    """A name as it is seen from everywhere; none for a relative one outside packages."""
    if not name.startswith("."):
        yield name
    elif package:
        try:
            yield resolve_name(name, package)
        except ImportError:
            return


def _called(node: ast.Call) -> str:
    return getattr(node.func, "id", getattr(node.func, "attr", ""))
