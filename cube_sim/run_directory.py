"""The folder one run writes into."""

from __future__ import annotations

import os
from datetime import UTC, datetime
from pathlib import Path

from .errors import RecordingError

FILES = ("run.mcap", "run.rrd", "resolved.yaml", "verdict.json")
"""Everything a run leaves behind."""


def default_directory(name: str) -> Path:
    """``logs/<name>-<UTC time>`` below the working directory, with a counter if it is taken."""
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%SZ")
    first = Path("logs", f"{name}-{stamp}")
    directory, count = first, 1
    while directory.exists():
        count += 1
        directory = first.with_name(f"{first.name}-{count}")
    return directory


def check(directory: Path) -> None:
    """Make sure that a run may write here: a new folder, an empty one, or an earlier run's. Writes nothing.

    Raises:
        RecordingError: it may not; the text says why.
    """
    try:
        entries = sorted(entry.name for entry in directory.iterdir())
    except FileNotFoundError:
        _check_can_be_made(directory)
        return
    except OSError as error:
        raise RecordingError(f"{directory}: cannot hold a recording: {error.strerror}") from error
    others = [name for name in entries if name not in FILES]
    if others:
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        raise RecordingError(
            f"{directory}: holds {others[0]}{more}, which no run wrote: give a new folder or that of an earlier run"
        )
    folders = [name for name in entries if (directory / name).is_dir()]
    if folders:
        raise RecordingError(f"{directory}: {folders[0]} is a folder, not a recording")
    if not os.access(directory, os.W_OK | os.X_OK):
        raise RecordingError(f"{directory}: cannot hold a recording: no permission to write")


def prepare(directory: Path) -> None:
    """Make the folder, or remove an earlier run from it.

    Raises:
        RecordingError: see `check`.
    """
    check(directory)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        for name in FILES:
            (directory / name).unlink(missing_ok=True)
    except OSError as error:
        raise RecordingError(f"{directory}: cannot hold a recording: {error.strerror}") from error


def _check_can_be_made(directory: Path) -> None:
    ancestor = directory.absolute().parent
    while not ancestor.exists():
        ancestor = ancestor.parent
    if not ancestor.is_dir():
        raise RecordingError(f"{directory}: cannot be made: {ancestor} is not a folder")
    if not os.access(ancestor, os.W_OK | os.X_OK):
        raise RecordingError(f"{directory}: cannot be made: no permission to write in {ancestor}")
