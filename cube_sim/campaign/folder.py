"""The folder of a sweep: what it is of, and its rows, those of a sweep that was killed as well.

    sweep.json              what is flown, and by which code
    parts/*.parquet         rows as they come, each file whole or not there at all
    rows.parquet            all rows once it is flown, in the order of the samples; times.parquet has the clock's
    runs/K/run.mcap         the recording of sample K, where it was to be kept

The rows of a part of a sweep, `--shard 2/5`, are called rows-2-of-5.parquet. The files of all parts may lie in one
folder.
"""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from cube_sim.campaign.rows import joined, samples_in, table_of, times_alone, without_times
from cube_sim.campaign.sample_flight import GO_ON, RUNS, FlownSample
from cube_sim.errors import DirectoryError, SweepError
from cube_sim.flight_statistics import STATISTICS
from cube_sim.locked_folder import FolderHeldError, held
from cube_sim.uninterrupted import uninterrupted
from cube_sim.whole_file import written_whole

SWEEP_FILE, ROWS, TIMES, PARTS, LOCK = "sweep.json", "rows", "times", "parts", ".lock"
UNREADY = ".sweep"
"""The first of them while it is written."""
EVERY_S = 1.0
"""Rows are written at least so often [s], where any come."""
MANY = 32
"""So many files of parts are made one."""


class Shard(NamedTuple):
    """A part of a sweep: samples number - 1, number - 1 + of, number - 1 + 2 of ...

    Attributes:
        number: which, from 1.
        of: how many parts there are.
    """

    number: int
    of: int

    @property
    def label(self) -> str:
        """What names of files end in; "" for the whole."""
        return "" if self.of == 1 else f"-{self.number}-of-{self.of}"

    def samples(self, count: int) -> range:
        """The numbers of its samples."""
        return range(self.number - 1, count, self.of)


WHOLE = Shard(1, 1)


@dataclass(frozen=True)
class SweepHead:
    """What a sweep is of: the content of sweep.json.

    Attributes:
        content: as plain data.
    """

    content: dict[str, Any]

    @classmethod
    def read(cls, folder: Path) -> SweepHead:
        """Of a folder.

        Raises:
            DirectoryError: it holds no sweep.
        """
        try:
            content = json.loads((folder / SWEEP_FILE).read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise DirectoryError(f"{folder}: is not the folder of a sweep: there is no {SWEEP_FILE} in it") from None
        except (OSError, ValueError) as error:
            raise DirectoryError(f"{folder}: {SWEEP_FILE} cannot be read: {error}") from None
        if not isinstance(content, dict) or content.get("format") != 1:
            raise DirectoryError(f"{folder}: {SWEEP_FILE} is of another version of cube_sim")
        return cls(content)


def rows_in(folder: Path, checks: Sequence[str] = ()) -> pa.Table:
    """All rows in a folder, those of parts of a sweep and of sweeps that were killed as well, with their times.

    Args:
        folder: of a sweep.
        checks: names of the scenario's checks, whose columns stand in this order.

    Raises:
        DirectoryError: a file cannot be read.
    """
    tables = []
    for file in sorted(folder.glob(f"{ROWS}*.parquet")):
        rows = _read(file)
        beside = file.with_name(file.name.replace(ROWS, TIMES, 1))
        times = _read(beside) if beside.is_file() else times_alone(joined([]))
        known = rows.join(times, "sample") if "flight_s" not in rows.column_names else rows
        tables.append(known)
    tables += [_read(file) for file in sorted((folder / PARTS).glob("[!.]*.parquet"))]
    return joined(tables, checks, STATISTICS)


def _read(file: Path) -> pa.Table:
    try:
        return pq.ParquetFile(file).read()  # of a folder's name it takes no columns
    except (OSError, pa.ArrowInvalid) as error:
        raise DirectoryError(f"{file}: cannot be read: {' '.join(str(error).split())}") from None


class SweepFolder:
    """Takes rows of a sweep as they come: what `append` has been told of and `stored` counts, no kill takes away.

    Args:
        folder: its own, made if need be.
        shard: which part of the sweep it is.
        checks: names of the scenario's checks.
        before: rows of an earlier beginning.

    Attributes:
        stored: how many samples are in its files.
    """

    def __init__(self, folder: Path, shard: Shard, checks: Sequence[str], before: pa.Table) -> None:
        self.path, self._shard, self._checks = folder, shard, checks
        self._waiting: list[FlownSample] = []
        self._written_at = time.monotonic()
        self._files: list[list[Path]] = []
        self._next = 0
        self.done = samples_in(before)
        self.stored = len(self.done)

    def append(self, flown: FlownSample) -> None:
        """Take one; it is written within a second, with those that come meanwhile.

        Raises:
            SweepError: it cannot be written.
        """
        self._waiting.append(flown)
        if time.monotonic() - self._written_at >= EVERY_S:
            self.flush()

    def flush(self) -> None:
        """Write what waits.

        Raises:
            SweepError: it cannot be written.
        """
        if self._waiting:
            with uninterrupted(), self._room():
                table = table_of(self._waiting)
                self._keep(table, 0)
                self.done |= samples_in(table)
                self.stored, self._waiting = len(self.done), []
        self._written_at = time.monotonic()

    def finish(self) -> pa.Table:
        """Make one file of all rows in the folder that are of this part of the sweep, or of the whole; these rows.

        Raises:
            SweepError: it cannot be written.
        """
        self.flush()
        with uninterrupted(), self._room():
            whole = rows_in(self.path, self._checks)
            if self._shard.of > 1:
                mine = pa.array([k % self._shard.of == self._shard.number - 1 for k in whole["sample"].to_pylist()])
                whole = whole.filter(mine)
            label = self._shard.label
            for name, table in ((ROWS, without_times(whole)), (TIMES, times_alone(whole))):
                with written_whole(self.path / f"{name}{label}.parquet") as part:
                    pq.write_table(table, part)
            self._clear()
        return whole

    @contextlib.contextmanager
    def _room(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            why = error.strerror or " ".join(str(error).split())
            raise SweepError(f"{self.path}: rows cannot be written: {why}; {GO_ON}") from None

    def _clear(self) -> None:
        """Remove what the file of all rows holds as well."""
        for file in (self.path / PARTS).glob(f"part{self._shard.label}_*.parquet"):
            file.unlink()
        if self._shard.of == 1:
            for name in (ROWS, TIMES):
                for file in self.path.glob(f"{name}-*-of-*.parquet"):
                    file.unlink()
            for file in (*(self.path / PARTS).glob("part*.parquet"), *self.path.glob(f"{LOCK}-*")):
                file.unlink()
        with contextlib.suppress(OSError):
            (self.path / PARTS).rmdir()

    def _keep(self, table: pa.Table, level: int) -> None:
        """Write a file of a level; many of one level become one of the next, so that there are never many."""
        folder = self.path / PARTS
        folder.mkdir(exist_ok=True)
        while len(self._files) <= level:
            self._files.append([])
        file = self._free(folder)
        with written_whole(file) as part:
            pq.write_table(table, part)
        self._files[level].append(file)
        if len(self._files[level]) >= MANY:
            files, self._files[level] = self._files[level], []
            self._keep(joined(map(_read, files), self._checks, STATISTICS), level + 1)
            for each in files:
                each.unlink()

    def _free(self, folder: Path) -> Path:
        while True:
            self._next += 1
            file = folder / f"part{self._shard.label}_{self._next:08d}.parquet"
            if not file.exists():
                return file


@contextlib.contextmanager
def opened(
    folder: Path, shard: Shard, head: dict[str, Any], *, resume: bool, checks: Sequence[str]
) -> Iterator[SweepFolder]:
    """Hold a folder for a sweep, or a part of one.

    Args:
        folder: new, empty, that of other parts of the sweep, or of an earlier beginning.
        shard: which part.
        head: what sweep.json says; of another sweep it may not be.
        resume: whether rows of an earlier beginning may be there, and are kept.
        checks: names of the scenario's checks.

    Raises:
        DirectoryError: it holds something else, or somebody else writes there.
    """
    with _as_directory_error(folder):
        _require_possible(folder, shard, head, resume=resume)
        folder.mkdir(parents=True, exist_ok=True)
    with _locked(folder, shard):
        _require_possible(folder, shard, head, resume=resume)  # only now is it certain that nobody else writes there
        own = folder / f"{UNREADY}{shard.label}"  # of a hundred parts that begin at once, each writes its own
        with _as_directory_error(folder):
            own.write_text(json.dumps(head, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
            own.replace(folder / SWEEP_FILE)
        yield SweepFolder(folder, shard, checks, rows_in(folder, checks))


def _require_possible(folder: Path, shard: Shard, head: dict[str, Any], *, resume: bool) -> None:
    if not folder.exists():
        return
    if not folder.is_dir():
        raise DirectoryError(f"{folder}: is not a folder")
    entries = [entry.name for entry in folder.iterdir() if not entry.name.startswith((LOCK, UNREADY))]
    if not entries:
        return
    if not (folder / SWEEP_FILE).is_file():
        raise DirectoryError(f"{folder}: holds {min(entries)}, not from a sweep: give a new folder")
    before = SweepHead.read(folder).content
    if differing := differences(before, head):
        what = "; ".join(differing)
        raise DirectoryError(f"{folder}: holds another sweep; what differs: {what}; give a new folder")
    if not resume and (_has_rows(folder, shard)):
        raise DirectoryError(f"{folder}: holds rows of this sweep: go on with --resume, or give a new folder")


def _has_rows(folder: Path, shard: Shard) -> bool:
    files = (f"{ROWS}{shard.label}.parquet", f"{PARTS}/part{shard.label}_*.parquet")
    return any(True for name in files for _ in folder.glob(name))


def differences(before: dict[str, Any], now: dict[str, Any]) -> list[str]:
    """In what two sweeps are not the same, in words."""
    from cube_sim.campaign.identity import Identity

    try:
        return Identity(**before["identity"]).differences(Identity(**now["identity"]))
    except (KeyError, TypeError):
        return [f"{SWEEP_FILE} of the two"]


@contextlib.contextmanager
def _locked(folder: Path, shard: Shard) -> Iterator[None]:
    """Hold a folder for the whole sweep, or beside others for a part, which has a file of its own for that.

    Such a file is removed by who holds the whole folder: whoever opens it finds the one that others have locked.
    """
    with contextlib.ExitStack() as locks:
        try:
            with _as_directory_error(folder):
                locks.enter_context(held(folder, with_others=shard.of > 1))
                if shard.of > 1:
                    lock = folder / f"{LOCK}{shard.label}"
                    lock.touch()
                    locks.enter_context(held(lock))
        except FolderHeldError:
            raise DirectoryError(f"{folder}: another sweep is writing there") from None
        yield


@contextlib.contextmanager
def _as_directory_error(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise DirectoryError(f"{folder}: cannot hold a sweep: {error.strerror}") from None


def recording_of(folder: Path, k: int) -> Path:
    """Where the recording of a sample is, if there is one."""
    return folder / RUNS / str(k)
