"""A recorded run as tables: a file per channel, names and units in the header."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel
from cube_sim.runs.recorded_run import RecordedRun

TIME = "t [s]"


class Table(NamedTuple):
    """The rows of one channel.

    Attributes:
        name: of the channel.
        columns: a name for each, with its unit in brackets; the first is the simulated time.
        rows: (n, 1 + width).
    """

    name: str
    columns: tuple[str, ...]
    rows: Rows


def tables_of(run: RecordedRun, wanted: Sequence[str] = ()) -> Iterator[Table]:
    """The tables of a run, those without rows left out.

    Args:
        run: the run.
        wanted: channels; none for all.
    """
    for channel in run.recording.channels:
        rows = run.recording.rows.get(channel.name)
        if rows is None or (wanted and channel.name not in wanted):
            continue
        yield Table(channel.name, _columns(run, channel), rows)


def table_of(run: RecordedRun, channel: str) -> Table:
    """The table of one channel, without rows where none were recorded.

    Raises:
        RecordingError: no such channel.
    """
    known = {each.name: each for each in run.recording.channels}
    if channel not in known:
        near = get_close_matches(channel, known, 1)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(known)}"
        raise RecordingError(f"{run.path}: no channel {channel!r}; {hint}")
    rows = run.recording.rows.get(channel, np.empty((0, 1 + known[channel].width)))
    return Table(channel, _columns(run, known[channel]), rows)


def pandas_frame(table: Table) -> Any:
    """A table as a frame of pandas.

    Raises:
        RecordingError: pandas is not installed.
    """
    return _library("pandas").DataFrame(_by_name(table))


def polars_frame(table: Table) -> Any:
    """A table as a frame of polars.

    Raises:
        RecordingError: polars is not installed.
    """
    return _library("polars").DataFrame(_by_name(table))


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise RecordingError(f"{name} is not installed: pip install {name}") from None


def _by_name(table: Table) -> dict[str, Rows]:
    return {name: table.rows[:, index] for index, name in enumerate(table.columns)}


def _columns(run: RecordedRun, channel: Channel) -> tuple[str, ...]:
    names = (name for field in channel.fields for name in run.column_names(f"{channel.name}.{field.name}"))
    return (TIME, *(name.removeprefix(f"{channel.name}.") for name in names))


def write_csv(table: Table, folder: Path) -> Path:
    """Write CHANNEL.csv; numbers so that they read back to the same bits.

    Raises:
        OSError: it cannot be written.
    """
    file = folder / f"{table.name}.csv"
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(table.columns)
        writer.writerows(table.rows.tolist())
    return file


def write_parquet(table: Table, folder: Path) -> Path:
    """Write CHANNEL.parquet, a column of float64 for each number.

    Raises:
        OSError: it cannot be written.
    """
    import pyarrow
    import pyarrow.parquet

    file = folder / f"{table.name}.parquet"
    pyarrow.parquet.write_table(pyarrow.table(_by_name(table)), file)
    return file
