"""A sweep in few numbers: what each check came to, and which samples are worst."""

from __future__ import annotations

import json
import shlex
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from cube_sim.campaign.sample_flight import CHECK
from cube_sim.scenario.document import parse
from cube_sim.spatial import Vector


class CheckSummary(NamedTuple):
    """What a check came to, over all samples.

    Attributes:
        name: of the check.
        passed: how many samples passed it.
        failed: how many failed it.
        errors: of how many it could not be judged.
        least_margin: the smallest margin; None where none was judged.
        worst: the sample that has it.
    """

    name: str
    passed: int
    failed: int
    errors: int
    least_margin: float | None
    worst: int | None


class WorstSample(NamedTuple):
    """A sample near the end of the list.

    Attributes:
        sample: its number.
        verdict: PASS, FAIL or ERROR.
        reason: why it did not pass; of one that did, its smallest margin.
        against: whether it speaks against the sweep.
    """

    sample: int
    verdict: str
    reason: str
    against: bool


def check_names(rows: pa.Table) -> list[str]:
    """Names of the checks that have a column."""
    ending = ".verdict"
    names = (name for name in rows.column_names if name.startswith(f"{CHECK}.") and name.endswith(ending))
    return [name.removeprefix(f"{CHECK}.").removesuffix(ending) for name in names]


def numbers(rows: pa.Table, column: str) -> Vector:
    """A column as (n,) numbers; NaN where there is none."""
    if pa.types.is_string(rows.schema.field(column).type):
        return np.full(rows.num_rows, np.nan)
    return np.array([np.nan if value is None else float(value) for value in rows[column].to_pylist()])


def check_summaries(rows: pa.Table) -> list[CheckSummary]:
    """What each check came to."""
    found = []
    for name in check_names(rows):
        verdicts = rows[f"{CHECK}.{name}.verdict"].to_pylist()
        margins = numbers(rows, f"{CHECK}.{name}.margin")
        known = bool(np.isfinite(margins).any())
        place = int(np.nanargmin(margins)) if known else 0
        found.append(
            CheckSummary(
                name,
                verdicts.count("PASS"),
                verdicts.count("FAIL"),
                verdicts.count("ERROR"),
                float(margins[place]) if known else None,
                rows["sample"][place].as_py() if known else None,
            )
        )
    return found


def limits_of(rows: pa.Table, name: str, limits: Mapping[str, float]) -> Vector:
    """The limit that each sample has of a check (n,), which may be drawn; NaN where nobody knows it."""
    column = f"{CHECK}.{name}.limit"
    given = np.full(rows.num_rows, limits.get(name, np.nan))
    if column not in rows.column_names:
        return given
    own = numbers(rows, column)
    return np.where(np.isnan(own), given, own)


def relative_margins(rows: pa.Table, limits: Mapping[str, float]) -> Vector:
    """The smallest margin of each sample, of any check, as a share of its limit (n,).

    Of a check whose limit is zero, or not known, it is a share of the largest margin. -inf where a sample could not be
    judged.
    """
    least = np.full(rows.num_rows, np.inf)
    for name in check_names(rows):
        margins, scale = numbers(rows, f"{CHECK}.{name}.margin"), np.abs(limits_of(rows, name, limits))
        largest = float(np.nanmax(np.abs(margins), initial=0.0)) or 1.0
        scale = np.where(scale > 0.0, scale, largest)  # of a limit of 0, or of one that nobody knows
        least = np.fmin(least, margins / scale)
    errors = np.array([verdict == "ERROR" for verdict in rows["verdict"].to_pylist()], dtype=bool)
    least[errors | np.isinf(least)] = -np.inf
    return least


def worst_samples(
    rows: pa.Table, limits: Mapping[str, float], most: int, against: Collection[int]
) -> list[WorstSample]:
    """Those that speak against the sweep, those not judged first, then by margin; then the closest others.

    Args:
        rows: of a sweep.
        limits: of the checks, by name.
        most: so many at most.
        against: numbers of the samples that speak against it.
    """
    if not rows.num_rows:
        return []
    margins = relative_margins(rows, limits)
    good = np.array([k not in against for k in rows["sample"].to_pylist()])
    order = np.lexsort((rows["sample"].to_numpy(), margins, good))[:most]
    found = []
    for place in order.tolist():
        verdict, reason = rows["verdict"][place].as_py(), rows["reason"][place].as_py()
        if verdict == "PASS":
            reason = f"smallest margin {100.0 * margins[place]:.3g} % of the limit"
            reason = reason if good[place] else f"passes, and should not; {reason}"
        found.append(WorstSample(rows["sample"][place].as_py(), verdict, reason, not good[place].item()))
    return found


def command_of(scenario: str | Path, settings: Mapping[str, Any], k: int) -> str:
    """What a shell takes to fly a sample again."""
    given = [word for path, value in settings.items() for word in ("--set", f"{path}={_as_yaml(value)}")]
    return shlex.join(["cube-sim", "run", str(scenario), "--sample", str(k), *given])


def _as_yaml(value: Any) -> str:
    """A plain value as --set takes it, in one line."""
    text = json.dumps(value, ensure_ascii=False)
    return str(value) if isinstance(value, str) and parse(value).data == value else text
