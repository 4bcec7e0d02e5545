"""Waypoints from a table in a text file."""

from __future__ import annotations

import csv
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import PathError

COLUMNS = ("x_m", "y_m", "z_m")
LARGEST_BYTES = 10_000_000
_NOT_USED = {
    "time": ("t", "time", "times", "timestamp", "stamp"),
    "speed": ("speed", "velocity", "vel", "v", "u"),
    "attitude": ("roll", "pitch", "yaw", "heading", "course"),
}
"""What whoever writes such a column expects to be flown, and a path of points does not say."""


def read_waypoints(path: Path, shown: str = "") -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """The points of a CSV file, and a name for each that says its row.

    The first row names the columns; those called x_m, y_m and z_m are read, in any order. Others are left alone,
    unless by their names they say when, how fast or in which attitude a point is passed: nothing would come of them.
    Empty rows and rows that begin with # are skipped.

    Args:
        path: the file, comma-separated UTF-8.
        shown: what to call it in messages; default its name.

    Returns:
        Points (n, 3) [m] and their n names.

    Raises:
        PathError: it cannot be read or a cell is no number; says file, row and column.
    """
    shown = shown or path.name
    rows = _rows(path, shown)
    if not rows:
        raise PathError(f"{shown} is empty; its first row must name the columns {', '.join(COLUMNS)}")
    line, header = rows[0]
    names = [cell.strip() for cell in header]
    missing = [column for column in COLUMNS if column not in names]
    if missing:
        raise PathError(f"{shown}, row {line}: no column {', '.join(missing)}; it has {', '.join(names)}")
    twice = [column for column in COLUMNS if names.count(column) > 1]
    if twice:
        raise PathError(f"{shown}, row {line}: column {twice[0]} is there twice")
    for name in names:
        word = name.lower().partition("_")[0].split("[")[0].split("(")[0].strip()
        for what, words in _NOT_USED.items():
            if word in words:
                raise PathError(
                    f"{shown}, row {line}: column {name} would have no effect, a table of points says no {what}: "
                    f"guidance and control.attitude do; take it out, or call it something else"
                )
    where = [(column, names.index(column)) for column in COLUMNS]
    points = [[_number(row, column, i, f"{shown}, row {line}") for column, i in where] for line, row in rows[1:]]
    if not points:
        raise PathError(f"{shown} names its columns but holds no points")
    return np.array(points), tuple(f"{shown}, row {line}" for line, _ in rows[1:])


def _rows(path: Path, shown: str) -> list[tuple[int, list[str]]]:
    """Every row that says something, with its number in the file."""
    try:
        if not path.is_file():
            raise PathError(f"no such file: {path}")
        if path.stat().st_size > LARGEST_BYTES:
            raise PathError(f"{shown} is larger than {LARGEST_BYTES} bytes, so it is no list of waypoints")
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file)
            return [(reader.line_num, row) for row in reader if any(map(str.strip, row)) and not row[0].startswith("#")]
    except UnicodeDecodeError:
        raise PathError(f"{shown} is not UTF-8 text") from None
    except (OSError, ValueError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise PathError(f"{shown} cannot be read: {reason}") from None


def _number(row: list[str], column: str, i: int, place: str) -> float:
    if i >= len(row) or not row[i].strip():
        raise PathError(f"{place}: column {column} is empty")
    text = row[i].strip()
    try:
        value = float(text)
    except ValueError:
        raise PathError(f"{place}: column {column} must be a number, got {text!r}") from None
    if not isfinite(value):
        raise PathError(f"{place}: column {column} must be finite, got {text}")
    return value
