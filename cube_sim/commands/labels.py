"""What runs beside one another are called."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

MOST = 32
"""So many characters of a name are written at most; the middle of a longer one is left out."""


def labels(runs: Sequence[Path], names: Sequence[str]) -> list[str]:
    """A short name for each run, all different.

    Args:
        runs: folders or records.
        names: of their scenarios.

    Returns:
        The scenarios' names; where they are the same, those of the folders; where these are as well, with numbers.
    """
    folders = [(run if run.is_dir() else run.absolute().parent).resolve().name for run in runs]
    for found in (names, folders):
        short = [_shortened(name) for name in found]
        if len({*short}) == len(short):
            return short
    return [f"{index}: {_shortened(name)}" for index, name in enumerate(names, 1)]


def _shortened(name: str) -> str:
    half = (MOST - 1) // 2
    return name if len(name) <= MOST else f"{name[:half]}…{name[-half:]}"
