"""Rows of a sweep as tables of Arrow: a type for each column, and an order that depends on no one's speed."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from cube_sim.campaign.sample_flight import CHECK, NOTE, FlownSample

FIRST = ("sample", "verdict", "reason", "seed")
"""Columns that stand first; then notes, what was drawn, the checks, and the rest."""
LAST = ("simulated_s", "traceback")
PARTS = ("value", "limit", "margin", "verdict", "at_s", "unit")
"""What a check has columns of."""
TIMES = ("flight_s", "wall_s")
"""Columns of the clock, kept apart: they are never the same again."""
_TYPES = {"sample": pa.int64(), "seed": pa.int64(), "simulated_s": pa.float64(), "flight_s": pa.float64()}
_TYPES |= {"wall_s": pa.float64(), **dict.fromkeys(("verdict", "reason", "traceback"), pa.string())}


def table_of(flown: Sequence[FlownSample]) -> pa.Table:
    """Rows and times of some samples, as they came."""
    rows = [{**each.row, "flight_s": each.flight_s, "wall_s": each.wall_s} for each in flown]
    names = dict.fromkeys(name for row in rows for name in row)
    return pa.table({name: _column(name, [row.get(name) for row in rows]) for name in names})


def _column(name: str, values: list[Any]) -> pa.Array:
    if name in _TYPES:
        return pa.array(values, _TYPES[name])
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {bool}:
        return pa.array(values, pa.bool_() if kinds else pa.null())
    if kinds <= {int} and all(value is None or -(2**63) <= value < 2**63 for value in values):
        return pa.array(values, pa.int64())
    if kinds <= {int, float}:
        return pa.array([None if value is None else float(value) for value in values], pa.float64())
    if kinds <= {str}:
        return pa.array(values, pa.string())
    return pa.array([value if value is None or isinstance(value, str) else json.dumps(value) for value in values])


def joined(tables: Iterable[pa.Table], checks: Sequence[str] = (), statistics: Sequence[str] = ()) -> pa.Table:
    """All rows, one for each sample, in the order of the samples.

    Args:
        tables: in any order; a sample may be in several of them, with the same row.
        checks: names of the scenario's checks, whose columns stand in this order.
        statistics: names of columns that stand behind them.
    """
    tables = list(tables)
    if not tables:
        return pa.table({name: pa.array([], _TYPES[name]) for name in (*FIRST, *LAST, *TIMES)})
    whole = pa.concat_tables(_of_one_type(tables), promote_options="permissive")
    samples = whole["sample"].to_numpy()
    _, first = np.unique(samples, return_index=True)
    whole = whole.take(pa.array(first))
    return whole.select(_ordered(whole.column_names, checks, statistics)).combine_chunks()


def _of_one_type(tables: list[pa.Table]) -> list[pa.Table]:
    """The same tables; a column that is text in one and something else in another is text in all of them."""
    kinds: dict[str, set[str]] = {}
    for table in tables:
        for field in table.schema:
            kinds.setdefault(field.name, set()).add(_kind(field.type))
    mixed = {name for name, found in kinds.items() if len(found - {"nothing"}) > 1}
    return [_as_text(table, mixed) if mixed else table for table in tables]


def _kind(of: pa.DataType) -> str:
    if pa.types.is_null(of):
        return "nothing"
    if pa.types.is_string(of):
        return "text"
    return "truth" if pa.types.is_boolean(of) else "number"


def _as_text(table: pa.Table, names: set[str]) -> pa.Table:
    for index, name in enumerate(table.column_names):
        if name in names and _kind(table.schema.field(index).type) != "text":
            values = table[name].to_pylist()
            text = pa.array([None if value is None else json.dumps(value) for value in values], pa.string())
            table = table.set_column(index, name, text)
    return table


def _ordered(names: Sequence[str], checks: Sequence[str], statistics: Sequence[str]) -> list[str]:
    """Names of columns in an order that the order of the rows has no part in."""
    known = [f"{CHECK}.{check}.{part}" for check in checks for part in PARTS]
    of_checks = [name for name in known if name in names]
    of_checks += sorted(name for name in names if name.startswith(f"{CHECK}.") and name not in known)
    ends = {*FIRST, *LAST, *TIMES, *of_checks, *statistics}
    drawn = sorted((name for name in names if name not in ends), key=lambda name: (not is_note(name), name))
    first, last = ([name for name in some if name in names] for some in (FIRST, (*statistics, *LAST, *TIMES)))
    return [*first, *drawn, *of_checks, *last]


def is_note(name: str) -> bool:
    """Whether a column holds a note of a generator."""
    return name.startswith(f"{NOTE}.")


def without_times(table: pa.Table) -> pa.Table:
    """The rows alone, which are the same whoever has flown them."""
    return table.select([name for name in table.column_names if name not in TIMES])


def times_alone(table: pa.Table) -> pa.Table:
    """What the clock said."""
    return table.select(["sample", *TIMES])


def samples_in(table: pa.Table) -> set[int]:
    """Numbers of the samples."""
    return set(table["sample"].to_pylist())
