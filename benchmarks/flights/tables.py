"""What became of missions, as tables on the terminal and files of figures."""

from __future__ import annotations

import csv
import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

Row = dict[str, Any]

COLUMNS = (
    "seed", "vehicle", "kind", "path", "ingredients", "faults", "speed_m_s", "through_water_m_s", "from_s", "forecast",
    "flown", "passes", "rms_m", "limit_m", "depth_m", "worst_m", "worst_late_m", "final_m", "advance", "not_exact",
    "attitude_rad", "false_alarms", "cause", "forecast_reason",
)  # fmt: skip


def write(rows: Sequence[Row], folder: Path, name: str) -> None:
    """All figures as JSON, those of `COLUMNS` as CSV."""
    (folder / f"{name}.json").write_text(json.dumps(list(rows), indent=1, default=str))
    with (folder / f"{name}.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows([_plain(row.get(column, "")) for column in COLUMNS] for row in rows)


def counts(rows: Iterable[Row], of: Callable[[Row], Iterable[str]]) -> list[tuple[str, int, int, int, int]]:
    """(group, missions, called flyable, of these passed, false alarms), in the order of the groups' names."""
    drawn, called, passed, alarms = Counter(), Counter(), Counter(), Counter()
    for row in rows:
        for group in of(row):
            drawn[group] += 1
            called[group] += bool(row.get("forecast"))
            passed[group] += bool(row.get("forecast") and row.get("passes"))
            alarms[group] += int(row.get("false_alarms") or 0)
    return [(group, drawn[group], called[group], passed[group], alarms[group]) for group in sorted(drawn)]


def print_counts(title: str, table: Iterable[tuple[str, int, int, int, int]]) -> None:
    """One line for each group."""
    print(f"\n{title:32s} {'drawn':>6s} {'yes':>6s} {'pass':>6s} {'alarms':>7s}")
    for group, drawn, called, passed, alarms in table:
        mark = "" if passed == called else f"   {called - passed} missed"
        print(f"{group:32s} {drawn:6d} {called:6d} {passed:6d} {alarms:7d}{mark}")


def print_missions(rows: Sequence[Row]) -> None:
    """Tables by kind, path, ingredient and vehicle; then every miss with its cause."""
    print_counts("kind", counts(rows, lambda row: [row["kind"]]))
    print_counts("path", counts(rows, lambda row: [row["path"]]))
    print_counts("ingredient", counts(rows, lambda row: row["ingredients"]))
    print_counts("vehicle", counts(rows, lambda row: [row["vehicle"]]))
    missed = [row for row in rows if row.get("forecast") and not row.get("passes")]
    print("\nmissed, by cause")
    for cause, number in Counter(cause_group(row) for row in missed).most_common():
        print(f"  {number:4d}  {cause}")
    for row in sorted(missed, key=lambda row: (cause_group(row), row["seed"])):
        rms = row.get("rms_m")
        figure = "-" if rms is None else f"{rms:.3f} m"
        added = "+".join(row["ingredients"]) or "plain"
        print(
            f"  --only {row['seed']}: {row['vehicle']}, {row['path']}, {added}: {figure}; {row['cause']}; {said(row)}"
        )
    survived = [row for row in rows if not row.get("forecast") and row.get("passes")]
    if survived:
        print("\nflown although the analysis says no")
        for row in survived:
            print(f"  --only {row['seed']}: {row['vehicle']}, {row['path']}: {row['forecast_reason'][:110]}")
    called, alarms = sum(bool(r.get("forecast")) for r in rows), sum(int(r.get("false_alarms") or 0) for r in rows)
    print(f"\n{called - len(missed)} of {called} that the analysis calls flyable pass; {alarms} false fault alarms")


def cause_group(row: Row) -> str:
    """The cause without its figures."""
    return str(row.get("cause", "not flown")).partition(",")[0].partition(":")[0]


def said(row: Row) -> str:
    """The first thing of weight in the run's log, or the faults."""
    weighty = [line for line in row.get("log", []) if "given up" in line or "ERROR" in line]
    return (weighty or [row.get("faults", "")])[0][:120]


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return f"{value:.5g}"
    return "+".join(map(str, value)) if isinstance(value, list | tuple) else value
