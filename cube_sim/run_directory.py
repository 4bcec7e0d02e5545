"""The folder one run writes into."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Collection, Iterable, Iterator
from datetime import UTC, datetime
from pathlib import Path

from cube_sim.errors import DirectoryError, RecordingError
from cube_sim.locked_folder import FolderHeldError, held
from cube_sim.whole_file import part_of, undone_if_left, written_whole

MCAP_FILE, RRD_FILE, RESOLVED_FILE, VERDICT_FILE = "run.mcap", "run.rrd", "resolved.yaml", "verdict.json"
FILES = (MCAP_FILE, RRD_FILE, RESOLVED_FILE, VERDICT_FILE)
"""Everything a run leaves behind."""
PARTS = tuple(part_of(Path(file)).name for file in FILES)
"""The same while they are begun: only a process that was killed leaves one behind."""
OURS = (*FILES, *PARTS)
VERDICT_BYTES = 32768
"""More than a verdict takes but for one of dozens of checks."""


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
    if record.is_file():
        return record
    if (path / VERDICT_FILE).is_file():
        raise RecordingError(f"{path}: is the folder of a run without a record: there is a verdict and no {MCAP_FILE}")
    if path.is_dir():
        raise RecordingError(f"{path}: is not the folder of a run: there is no {MCAP_FILE} in it")
    raise RecordingError(f"{path}: is not a regular file, no record" if path.exists() else f"{path}: no such file")


def reserve_verdict(directory: Path) -> None:
    """Take the room of verdict.json now: a run that finds the disk full can still say so there.

    Raises:
        OSError: there is none.
    """
    with part_of(directory / VERDICT_FILE).open("wb") as part:
        part.write(bytes(VERDICT_BYTES))


def write_verdict(directory: Path, text: str) -> None:
    """Write verdict.json, whole or not at all, into the room that may have been reserved.

    Raises:
        OSError: it cannot be written; what stood there before is as it was.
    """
    with written_whole(directory / VERDICT_FILE) as part:
        part.touch()
        with part.open("r+b") as file:
            file.write(text.encode())
            file.truncate()


class Claim:
    """A folder held for one run; an earlier run's files stay in it until this one has something to put there.

    Attributes:
        directory: the folder.
        begun: whether the run has begun to write: whether `begin` was called.
        judged: whether the flight came to its own end and all that a run leaves is written, but for its view.
    """

    def __init__(self, directory: Path, made: bool) -> None:
        self.directory, self.begun, self.judged, self._made = directory, False, False, made

    def begin(self, but: Collection[str] = ()) -> None:
        """Remove an earlier run's files: from now on the folder is this run's. Once is enough.

        Args:
            but: those that another takes the place of in one move, which no kill comes amid.

        Raises:
            DirectoryError: they cannot be removed.
        """
        if not self.begun:
            with _as_directory_error(self.directory):
                self.remove(file for file in FILES if file not in but)
            self.begun = True

    def remove(self, files: Iterable[str]) -> None:
        """Remove files of these names where there are any.

        Raises:
            OSError: one of them cannot be removed.
        """
        for file in files:
            (self.directory / file).unlink(missing_ok=True)

    def leave(self) -> None:
        """Remove what is half written, and the folder too if it was made for a run that has not begun."""
        with contextlib.suppress(OSError):
            self.remove(PARTS)
            if self._made and not self.begun:
                self.directory.rmdir()


_claims: list[Claim] = []
"""Of the runs of this process."""


def nothing_recorded() -> bool:
    """Whether a run of this process has claimed its folder, and not begun to record."""
    return any(not each.begun for each in _claims)


@contextlib.contextmanager
def claim(directory: Path | None, name: str) -> Iterator[Claim]:
    """Hold a folder for one run: made if need be, closed to other runs.

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
        own = Claim(directory, made)
        with _as_directory_error(directory):
            own.remove(PARTS)  # of a process that was killed
        _claims.append(own)
        try:
            with undone_if_left(own.leave):
                yield own
        finally:
            _claims.remove(own)


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
    with contextlib.ExitStack() as locks:
        try:
            with _as_directory_error(directory):
                locks.enter_context(held(directory))
        except FolderHeldError:
            raise DirectoryError(f"{directory}: another run is writing there") from None
        yield


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
