"""A recorded run as tables: a file per channel, names and units in the header, codes as numbers and as words."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cube_sim.errors import RecordingError
from cube_sim.nearest import among
from cube_sim.recording.batch import Rows
from cube_sim.recording.channels import Channel
from cube_sim.runs.recorded_run import RecordedRun

TIME = "t [s]"
WORD = "name"
"""In brackets, where other columns have their unit: of a column that has the words of the codes before it."""


class Words(NamedTuple):
    """What codes mean.

    Attributes:
        known: what 0, 1, 2 ... mean.
        words: of each row; None where its code is none of these.
    """

    known: tuple[str, ...]
    words: tuple[str | None, ...]


class Table(NamedTuple):
    """The rows of one channel.

    Attributes:
        name: of the channel.
        columns: a name for each, with its unit in brackets; the first is the simulated time.
        rows: (n, 1 + width).
        labels: of columns that are codes, what 0, 1, 2 ... mean, by their index.
    """

    name: str
    columns: tuple[str, ...]
    rows: Rows
    labels: Mapping[int, tuple[str, ...]]

    def parts(self) -> Iterator[tuple[str, Rows | Words]]:
        """Every column by its name; behind one of codes another has their words."""
        for index, name in enumerate(self.columns):
            codes = self.rows[:, index]
            yield name, codes
            if index in self.labels:
                yield f"{name.rpartition(' [')[0]} [{WORD}]", Words(self.labels[index], tuple(_words(self, index)))


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
        yield _table(run, channel, rows)


def table_of(run: RecordedRun, channel: str) -> Table:
    """The table of one channel, without rows where none were recorded.

    Raises:
        RecordingError: no such channel.
    """
    known = {each.name: each for each in run.recording.channels}
    if channel not in known:
        near = get_close_matches(channel, known, 1)
        hint = f"did you mean {near[0]}?" if near else f"there are {among(channel, known)}"
        raise RecordingError(f"{run.path}: no channel {channel!r}; {hint}")
    rows = run.recording.rows.get(channel, np.empty((0, 1 + known[channel].width)))
    return _table(run, known[channel], rows)


def pandas_frame(table: Table) -> Any:
    """A table as a frame of pandas.

    Raises:
        RecordingError: pandas is not installed.
    """
    pandas = _library("pandas")
    columns = {
        name: pandas.Categorical(part.words, part.known) if isinstance(part, Words) else part
        for name, part in table.parts()
    }
    return pandas.DataFrame(columns)


def polars_frame(table: Table) -> Any:
    """A table as a frame of polars.

    Raises:
        RecordingError: polars is not installed.
    """
    polars = _library("polars")
    columns = {
        name: polars.Series(name, part.words, polars.Enum(part.known)) if isinstance(part, Words) else part
        for name, part in table.parts()
    }
    return polars.DataFrame(columns)


def _library(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise RecordingError(f"{name} is not installed: pip install {name}") from None


def _table(run: RecordedRun, channel: Channel, rows: Rows) -> Table:
    names = (name for field in channel.fields for name in run.column_names(f"{channel.name}.{field.name}"))
    labels = {
        index: field.labels
        for field, columns in zip(channel.fields, channel.columns, strict=True)
        for index in range(columns.start, columns.stop)
        if field.labels
    }
    return Table(channel.name, (TIME, *(name.removeprefix(f"{channel.name}.") for name in names)), rows, labels)


def _words(table: Table, index: int) -> Iterator[str | None]:
    labels = dict(enumerate(table.labels[index]))
    return (labels.get(code) for code in table.rows[:, index].tolist())  # 2.0 finds 2


def _file(folder: Path, name: str) -> Path:
    """Of a table; those of one vehicle among several are in a folder of its name."""
    file = folder / name
    file.parent.mkdir(exist_ok=True)
    return file


def write_csv(table: Table, folder: Path) -> Path:
    """Write CHANNEL.csv; numbers so that they read back to the same bits, a code without a word as an empty one.

    Raises:
        OSError: it cannot be written.
    """
    file = _file(folder, f"{table.name}.csv")
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        names, parts = zip(*table.parts(), strict=True)
        writer.writerow(names)
        writer.writerows(zip(*(p.words if isinstance(p, Words) else p.tolist() for p in parts), strict=True))
    return file


def write_parquet(table: Table, folder: Path) -> Path:
    """Write CHANNEL.parquet, a column of float64 for each number, and a dictionary of the words of codes.

    Raises:
        OSError: it cannot be written.
    """
    import pyarrow
    import pyarrow.parquet

    file = _file(folder, f"{table.name}.parquet")
    columns = {name: _arrow_words(part) if isinstance(part, Words) else part for name, part in table.parts()}
    pyarrow.parquet.write_table(pyarrow.table(columns), file)
    return file


def _arrow_words(words: Words) -> Any:
    import pyarrow

    number = {word: index for index, word in enumerate(words.known)}
    codes = pyarrow.array([None if word is None else number[word] for word in words.words], pyarrow.int8())
    return pyarrow.DictionaryArray.from_arrays(codes, pyarrow.array(words.known))
