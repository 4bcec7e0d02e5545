"""The folder one run writes into."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from cube_sim.errors import DirectoryError, RecordingError

try:
    import fcntl
except ImportError:  # no such locks on Windows
    fcntl = None

MCAP_FILE, RRD_FILE, RESOLVED_FILE, VERDICT_FILE = "run.mcap", "run.rrd", "resolved.yaml", "verdict.json"
PART_FILE = ".verdict.json.part"
"""The verdict while it is written: only a process that was killed leaves it behind."""
FILES = (MCAP_FILE, RRD_FILE, RESOLVED_FILE, VERDICT_FILE)
"""Everything a run leaves behind."""
OURS = (*FILES, PART_FILE)


def require_writable(directory: Path) -> None:
    """Make sure that a run may write here: a new folder, an empty one, or an earlier run's. Writes nothing.

    Raises:
        DirectoryError: it may not; the text says why.
    """
    try:
        entries = sorted(entry.name for entry in directory.iterdir())
    except FileNotFoundError:
        _check_can_be_made(directory)
        return
    except OSError as error:
        raise DirectoryError(f"{directory}: cannot hold a recording: {error.strerror}") from error
    others = [name for name in entries if name not in OURS]
    if others:
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        raise DirectoryError(
            f"{directory}: holds {others[0]}{more}, not from a run: give a new folder or that of an earlier run"
        )
    folders = [name for name in entries if (directory / name).is_dir()]
    if folders:
        raise DirectoryError(f"{directory}: {folders[0]} is a folder, not a recording")
    if not os.access(directory, os.W_OK | os.X_OK):
        raise DirectoryError(f"{directory}: cannot hold a recording: no permission to write")


def record_of(path: Path) -> Path:
    """The record that a user means by the folder of a run, or by the record itself.

    Raises:
        RecordingError: there is none.
    """
    record = path / MCAP_FILE if path.is_dir() else path
    if not record.is_file():
        raise RecordingError(f"{path}: no {MCAP_FILE} here" if path.is_dir() else f"{path}: no such file")
    return record


def write_verdict(directory: Path, text: str) -> None:
    """Write verdict.json, whole or not at all.

    Raises:
        OSError: it cannot be written; what stood there before is as it was.
    """
    part = directory / PART_FILE
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(directory / VERDICT_FILE)
    except OSError:
        part.unlink(missing_ok=True)
        raise


_claimed: dict[Path, bool] = {}
"""Folders that runs of this process write into, and whether they were made for that."""


def abandon() -> bool:
    """Remove what the runs of this process have begun to write; whether there are any.

    For a process that ends before anything was flown.
    """
    for directory, made in _claimed.items():
        with contextlib.suppress(OSError):
            for file in OURS:
                (directory / file).unlink(missing_ok=True)
            if made:
                directory.rmdir()
    return bool(_claimed)


@contextlib.contextmanager
def claim(directory: Path | None, name: str) -> Iterator[Path]:
    """Hold a folder for one run: made if need be, an earlier run removed from it, closed to other runs.

    The claim is a lock on the folder itself, which the system lets go when the process ends, however it ends: no
    claim outlives its run. Where the file system knows no locks, the folder is not closed.

    Args:
        directory: the folder; None for a new one, ``logs/<name>-<UTC time>`` below the working directory.
        name: the scenario's.

    Raises:
        DirectoryError: see `require_writable`; or another run is writing there.
    """
    made = directory is None or not directory.exists()
    if directory is None:
        directory = _make_new(name)
    else:
        require_writable(directory)
        with _as_directory_error(directory):
            directory.mkdir(parents=True, exist_ok=True)
    with _locked(directory):
        # Only now is it certain that nobody else writes here.
        require_writable(directory)
        with _as_directory_error(directory):
            for file in OURS:
                (directory / file).unlink(missing_ok=True)
        _claimed[directory] = made
        try:
            yield directory
        finally:
            del _claimed[directory]


def _make_new(name: str) -> Path:
    """Make the first free one of ``logs/<name>-<UTC time>``, ``...-2``, ``...-3``: making it is what takes it."""
    first = Path("logs", f"{name}-{datetime.now(UTC).strftime('%Y%m%dT%H%M%SZ')}")
    directory, count = first, 1
    with _as_directory_error(first):
        first.parent.mkdir(exist_ok=True)
        while True:
            with contextlib.suppress(FileExistsError):
                directory.mkdir()
                return directory
            count += 1
            directory = first.with_name(f"{first.name}-{count}")


@contextlib.contextmanager
def _locked(directory: Path) -> Iterator[None]:
    if fcntl is None:
        yield
        return
    with _as_directory_error(directory):
        folder = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise DirectoryError(f"{directory}: another run is writing there") from None
        except OSError:
            pass  # a file system without locks
        yield
    finally:
        os.close(folder)


@contextlib.contextmanager
def _as_directory_error(directory: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise DirectoryError(f"{directory}: cannot hold a recording: {error.strerror}") from error


def _check_can_be_made(directory: Path) -> None:
    if directory.is_symlink():
        raise DirectoryError(f"{directory}: cannot hold a recording: a link that leads nowhere")
    ancestor = directory.absolute().parent
    while not ancestor.exists():
        ancestor = ancestor.parent
    if not ancestor.is_dir():
        raise DirectoryError(f"{directory}: cannot be made: {ancestor} is not a folder")
    if not os.access(ancestor, os.W_OK | os.X_OK):
        raise DirectoryError(f"{directory}: cannot be made: no permission to write in {ancestor}")
