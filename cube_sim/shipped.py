"""Models and scenarios that come with the package."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def shipped_root(package: Path = _PACKAGE) -> Path:
    """The folder with the folders `models` and `scenarios`.

    A wheel holds them inside the package, where `pyproject.toml` puts them; a checkout at its top.

    Args:
        package: the folder of the package `cube_sim`.
    """
    shipped = package / "examples"
    return shipped if shipped.is_dir() else package.parent
