"""Signals of an earlier run, with which a run is compared: from its record, or from a table of one of them."""

from __future__ import annotations

import io
from collections.abc import Mapping
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cube_sim.errors import RecordingError, told
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.mcap.passing import NotInOrderError
from cube_sim.recording.one_pass import OnePass
from cube_sim.recording.reading import Recording, read_recording
from cube_sim.run_directory import record_of

TABLE = ".npy"
"""What a file is called that holds the rows of one signal alone, as NumPy saves an array."""


class BaselineSignal(NamedTuple):
    """One signal of an earlier run.

    Attributes:
        rows: (n, 1 + width), column 0 the time [s].
        unit: of its numbers; "" where a table does not say it.
    """

    rows: Rows
    unit: str


def baseline_signal(record: str, signal: str, files: Mapping[str, bytes] | None = None) -> BaselineSignal:
    """Read a signal of an earlier run; little more than its own rows is in memory.

    Args:
        record: folder of the run, its MCAP file, or a .npy table of the signal.
        signal: channel.field.
        files: contents of files that are looked for here first, by name: those that a record carries.

    Raises:
        RecordingError: it cannot be had, in a line.
    """
    if files is not None and record in files:
        return BaselineSignal(_table(files[record], record), "")
    path = Path(record)
    try:
        if path.suffix == TABLE:
            return BaselineSignal(_table(path.read_bytes(), record), "")
        path = record_of(path)
        stamp = path.stat()
    except OSError as error:
        raise RecordingError(f"{record}: cannot be read: {told(error)}") from None
    return _recorded(path, signal, stamp.st_mtime_ns, stamp.st_size)


def table_of_rows(rows: Rows) -> bytes:
    """The same rows as a file of their own."""
    file = io.BytesIO()
    np.save(file, np.ascontiguousarray(rows), allow_pickle=False)
    return file.getvalue()


def _table(content: bytes, name: str) -> Rows:
    try:
        rows = np.load(io.BytesIO(content), allow_pickle=False)
    except (ValueError, OSError, EOFError) as error:
        raise RecordingError(f"{name}: is no table of numbers: {told(error)}") from None
    if not isinstance(rows, np.ndarray) or rows.ndim != 2 or rows.shape[1] < 2 or rows.dtype != np.float64:
        raise RecordingError(f"{name}: must hold rows of float64, the time [s] and the numbers of the signal")
    if not len(rows) or not np.isfinite(rows).all() or np.any(np.diff(rows[:, 0]) <= 0):
        raise RecordingError(f"{name}: must hold finite numbers, in the order of time")
    return rows


@lru_cache(maxsize=16)
def _recorded(path: Path, signal: str, changed_ns: int, size: int) -> BaselineSignal:
    """Of a record that has not been written since: it is asked for before the flight, and by each check."""
    try:
        read = OnePass(path)
        channel, column = _place(path, read.beginning.channels, signal)
        parts = [rows[channel.name] for rows in read.blocks() if channel.name in rows]
        parts = [np.hstack([rows[:, :1], rows[:, channel.columns[column]]]) for rows in parts]
        whole = read.finish()
        rows = np.concatenate([np.empty((0, 1 + channel.fields[column].width)), *parts])
    except NotInOrderError:
        whole = read_recording(path)
        channel, column = _place(path, whole.channels, signal)
        rows = whole.signals[signal]
    _require_unaltered(path, whole)
    if not len(rows):
        raise RecordingError(f"{path}: has no rows of {signal}")
    return BaselineSignal(rows, channel.fields[column].unit)


def _place(path: Path, channels: tuple[Channel, ...], signal: str) -> tuple[Channel, int]:
    known: dict[str, tuple[Channel, int]] = {}
    for channel in channels:
        field: Field
        for index, field in enumerate(channel.fields):
            known[f"{channel.name}.{field.name}"] = channel, index
    if signal not in known:
        near = ", ".join(get_close_matches(signal, known, n=3, cutoff=0.0)) or "none"
        raise RecordingError(f"{path}: records no signal '{signal}'; the nearest of {len(known)} are {near}")
    return known[signal]


def _require_unaltered(path: Path, whole: Recording) -> None:
    if whole.changed:
        raise RecordingError(f"{path}: {whole.changed}")
