"""A recorded run as tables: a file per channel, names and units in the header."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from cube_sim.recording.batch import Rows
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
        names = (name for field in channel.fields for name in run.column_names(f"{channel.name}.{field.name}"))
        short = (name.removeprefix(f"{channel.name}.") for name in names)
        yield Table(channel.name, (TIME, *short), rows)


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
    columns = {name: table.rows[:, index] for index, name in enumerate(table.columns)}
    pyarrow.parquet.write_table(pyarrow.table(columns), file)
    return file
