"""Which of what was varied goes with what came out: rank correlation.

Spearman's coefficient, -1 to 1: 0 where ranks tell nothing of each other. It sees what only rises, or only falls; of n
samples without any connection it lies within 2 / sqrt(n) mostly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pyarrow as pa
from scipy.stats import rankdata
from scipy.stats import t as students

from cube_sim.campaign.counting import LONGEST
from cube_sim.campaign.rows import FIRST, LAST, TIMES
from cube_sim.campaign.sample_flight import CHECK
from cube_sim.campaign.summary import numbers
from cube_sim.flight_statistics import STATISTICS
from cube_sim.scenario.samples_block import LOST_THRUSTERS
from cube_sim.spatial import Vector

MOST_WORDS = 12
"""A column of text with more different words than this is no category."""


class Parameter(NamedTuple):
    """Something that was varied, as numbers.

    Attributes:
        name: of the column; of a word in it, `name = word`.
        values: (n,); 1 and 0 for a word that is there, or not.
        is_number: whether it was a number from the beginning.
    """

    name: str
    values: Vector
    is_number: bool


class Correlation(NamedTuple):
    """How ranks go together.

    Attributes:
        rho: Spearman's coefficient; NaN where one of the two never changes.
        p: how likely one as far from 0 is where there is no connection.
    """

    rho: float
    p: float


def drawn_columns_of(rows: pa.Table) -> list[str]:
    """Names of the columns of what was varied."""
    others = {*FIRST, *LAST, *TIMES, *STATISTICS}
    return [name for name in rows.column_names if name not in others and not name.startswith(f"{CHECK}.")]


def parameters_of(rows: pa.Table, thrusters: Sequence[str] = ()) -> list[Parameter]:
    """What was varied; what is the same in all samples is left out.

    Args:
        rows: of a sweep.
        thrusters: names of those that may be lost: each is a parameter.
    """
    found = []
    for name in drawn_columns_of(rows):
        if name == LOST_THRUSTERS:
            lost = [set(filter(None, (text or "").split("+"))) for text in rows[name].to_pylist()]
            found.append(Parameter(f"number of {LOST_THRUSTERS}", np.array([float(len(each)) for each in lost]), True))
            for thruster in thrusters:
                gone = np.array([float(thruster in each) for each in lost])
                found.append(Parameter(f"{LOST_THRUSTERS}: {thruster}", gone, False))
        elif pa.types.is_string(rows.schema.field(name).type):
            words = rows[name].to_pylist()
            different = sorted({word for word in words if word is not None})
            if len(different) <= MOST_WORDS and max(map(len, different), default=0) <= LONGEST:
                for word in different:
                    there = np.array([float(each == word) for each in words])
                    found.append(Parameter(f"{name} = {word}", there, False))
        else:
            found.append(Parameter(name, numbers(rows, name), True))
    found += _lengths(found)
    return [each for each in found if len(np.unique(each.values[~np.isnan(each.values)])) > 1]


def _lengths(found: Sequence[Parameter]) -> list[Parameter]:
    """Of every vector of which more than one column was varied: what none of its parts tells."""
    parts: dict[str, list[Vector]] = {}
    for each in found:
        base, _, column = each.name.rpartition(".")
        if each.is_number and base and column.isdigit():
            parts.setdefault(base, []).append(each.values)
    return [
        Parameter(f"length of {base}", np.linalg.norm(np.column_stack(columns), axis=1), True)
        for base, columns in parts.items()
        if len(columns) > 1
    ]


def rank_correlation(x: Vector, y: Vector) -> Correlation:
    """Of two columns (n,); where one of the two is NaN, that sample is left out."""
    both = ~(np.isnan(x) | np.isnan(y))
    n = int(np.count_nonzero(both))
    if n < 3:
        return Correlation(np.nan, np.nan)
    a, b = (rankdata(each[both]) for each in (x, y))
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    if size == 0.0:
        return Correlation(np.nan, np.nan)
    rho = min(1.0, max(-1.0, float(a @ b) / size))
    if abs(rho) == 1.0:
        return Correlation(rho, 0.0)
    return Correlation(rho, float(2.0 * students.sf(abs(rho) * np.sqrt((n - 2) / (1.0 - rho * rho)), n - 2)))
