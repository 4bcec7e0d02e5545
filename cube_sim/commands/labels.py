"""What runs beside one another are called."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


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
        if len({*found}) == len(found):
            return list(found)
    return [f"{index}: {name}" for index, name in enumerate(names, 1)]
