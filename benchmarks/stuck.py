"""Fly every single thruster of every vehicle dead and stuck, beside a plain PID and beside doing nothing.

    python benchmarks/stuck.py --out logs/stuck
    python benchmarks/stuck.py --vehicles cube 'drawn6*' --paths point
    python benchmarks/stuck.py --draws 40 --seed 7 --no-foils

Each thruster of each vehicle of `tests/support/catalogue/vehicles.py` dies, or sticks at half of either of its limits
or at the limits, once the vehicle is settled on a level line or at a point in still water; 40 s are flown from there.
`--draws N` draws vehicle, layout, path, speed, current and forces by seed instead. A flight is held where it ends
within half a metre of its path. What the analysis said of each beforehand stands beside it, and the bound of the
transient where there is one: no flight may leave its path by more.

Writes stuck.csv and stuck.json.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import signal
import sys
import time
from itertools import product
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
# One flight takes one core; the processes share them.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

import numpy as np  # noqa: E402
from flights.beside import HELD_M, Row, Task, flown  # noqa: E402
from flights.workers import in_processes  # noqa: E402
from support.catalogue.drawn import LEAST, MOST  # noqa: E402
from support.catalogue.vehicles import catalogue  # noqa: E402

PROCESSOR_S = 1800.0
"""Processor time the flights of one vehicle on one path may take."""
NEAR_M = 0.01
"""Nearer to its path than this, ratios of what was foreseen say nothing."""
WORSE_M, SHOWN = 0.5, 25
"""A flight that ends so much farther off than a foil is worse, and how many of these are listed."""
DRAWN_PATHS = ("line", "point", "arc", "circle", "helix", "sinusoid", "spline")


def main() -> None:
    """Fly, and write the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--vehicles", nargs="+", metavar="NAME", default=["*"], help="these, or those like NAME*")
    parser.add_argument("--paths", nargs="+", choices=("line", "point"), default=["line", "point"])
    parser.add_argument("--draws", type=int, default=0, help="so many drawn tasks instead")
    parser.add_argument("--seed", type=int, default=0, help="of the first draw")
    parser.add_argument("--half", type=int, choices=(0, 1), help="only every other vehicle")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="flights at a time")
    parser.add_argument("--no-foils", action="store_true", help="fly the law alone")
    parser.add_argument("--out", type=Path, default=Path("logs/stuck"), help="folder for the table and the models")
    arguments = parser.parse_args()
    if arguments.jobs < 1 or arguments.draws < 0 or arguments.seed < 0:
        parser.error("--jobs must be 1 at least, --draws and --seed 0")
    tasks = drawn(arguments.draws, arguments.seed) if arguments.draws else listed(parser, arguments)
    arguments.out.mkdir(parents=True, exist_ok=True)
    # The processes of the flights end with this one, also when it is told to.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    started, rows = time.perf_counter(), []
    calls = [(task, arguments.out / "models", not arguments.no_foils) for task in tasks]
    for index, good, value in in_processes(
        flown, calls, jobs=arguments.jobs, cpu_s=PROCESSOR_S, wall_s=20.0 * PROCESSOR_S
    ):
        print(f"{tasks[index].vehicle} {tasks[index].path}: {_words(value) if good else value}", flush=True)
        rows += value if good else []
        write(rows, arguments.out)
    print_summary(rows)
    print(f"{time.perf_counter() - started:.0f} s; table and models: {arguments.out}")


def listed(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> list[Task]:
    """Every whole vehicle asked for, on each path."""
    names = [name for name, entry in catalogue().items() if not entry.lost]
    if arguments.half is not None:
        names = names[arguments.half :: 2]
    found = []
    for name in arguments.vehicles:
        some = [n for n in names if n == name or (name.endswith("*") and n.startswith(name[:-1]))]
        if not some:
            parser.error(f"--vehicles {name}: no such vehicle without losses")
        found += [n for n in some if n not in found]
    return [Task(name, path) for name in found for path in arguments.paths]


def drawn(count: int, seed: int) -> list[Task]:
    """Tasks by seed: of every third the layout, too, is drawn anew."""
    tasks = []
    names = [name for name, entry in catalogue().items() if not (entry.lost or entry.planar)]
    for k in range(seed, seed + count):
        rng = np.random.default_rng([42, k])
        fresh = f"fresh{int(rng.integers(LEAST, MOST + 1))}_{1000 + k}"
        name = fresh if k % 3 == 0 else str(rng.choice(names))
        tasks.append(Task(name, str(rng.choice(DRAWN_PATHS)), k))
    return tasks


def write(rows: list[Row], folder: Path) -> None:
    """One row per flight."""
    (folder / "stuck.json").write_text(json.dumps(rows, indent=1, default=float))
    if not rows:
        return
    columns = list(dict.fromkeys(key for row in rows for key in row if key != "said"))
    with (folder / "stuck.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


def print_summary(rows: list[Row]) -> None:
    """What was held, as was said beforehand and beside the foils, and whether any bound was broken."""
    head = f"{'held':>10s}{'said yes':>10s}{'held':>6s}{'said no':>9s}{'held':>6s}{'PID held':>10s}{'off':>5s}"
    print(f"\n{'':18s}{'flights':>8s}{head}{'error [m]: median':>19s}{'PID':>7s}{'bounds':>8s}{'broken':>8s}")
    for path, state in product(("path", "point"), ("dead", "half", "limit", "drawn")):
        some = [row for row in rows if (row["path"] == "point") == (path == "point") and kind(row) == state]
        if not some:
            continue
        yes, no = [r for r in some if r["follows"]], [r for r in some if not r["follows"]]
        counts = [len(some), held(some), len(yes), held(yes), len(no), held(no), held(some, "pid"), held(some, "off")]
        worst = [float(np.median([row.get(f"{name}_worst_m", np.nan) for row in some])) for name in ("law", "pid")]
        bound = [row for row in some if not row["no_bound"]]
        broken = sum(not row["within"] for row in bound)
        widths = zip(counts, (8, 10, 10, 6, 9, 6, 10, 5), strict=True)
        figures = "".join(f"{count:{width}d}" for count, width in widths)
        print(f"{path + ', ' + state:18s}{figures}{worst[0]:19.3f}{worst[1]:7.2f}{len(bound):8d}{broken:8d}")
    told = [row for row in rows if row["with_margin_m"] is not None]
    beyond = [row for row in told if row["law_worst_m"] > row["with_margin_m"] + row["start_m"]]
    far = [row["foreseen_m"] / row["law_worst_m"] for row in told if row["law_worst_m"] > NEAR_M]
    if far:
        shares = ", ".join(f"{share:.2f}" for share in np.percentile(far, [5, 50, 95]))
        print(f"foreseen beforehand for {len(told)}: {shares} of what was flown (5 %, median, 95 %)")
    for row in beyond:
        print(f"BEYOND: {said(row)}; foreseen {row['foreseen_m']:.3f} m, {row['with_margin_m']:.3f} m with a margin")
    for row in rows:
        if not row["within"]:
            print(f"BROKEN: {said(row)}, at most {row['bound_m']:.3f} m")
    for name in ("pid", "off"):
        worse = [row for row in rows if row.get(f"{name}_end_m", np.inf) + WORSE_M < row["law_end_m"]]
        print(f"\n{len(worse)} end farther off than {'a PID' if name == 'pid' else 'with all thrusters off'}")
        for row in sorted(worse, key=lambda r: r[f"{name}_end_m"] - r["law_end_m"])[:SHOWN]:
            print(f"  {said(row)}; the other {row[f'{name}_end_m']:.2f} m; {row['said'][0] if row['said'] else ''}")


def kind(row: Row) -> str:
    """Of a fault: dead, stuck at half of a limit or at a limit, or drawn."""
    return "drawn" if row["seed"] is not None else row["kind"]


def held(rows: list[Row], name: str = "law") -> int:
    """How many are held."""
    return sum(row.get(f"{name}_end_m", np.inf) <= HELD_M for row in rows)


def said(row: Row) -> str:
    """A flight in words."""
    force = "dead" if row["force_N"] is None else f"at {row['force_N']:.1f} N"
    where = "point" if row["path"] == "point" else row["path"]
    return (
        f"{row['vehicle']} {where} {row['thruster']} {force}: {row['law_worst_m']:.2f} m, ends {row['law_end_m']:.2f} m"
    )


def _words(rows: list[Row]) -> str:
    held: Any = sum(row["held"] for row in rows)
    return f"{held} of {len(rows)} held, largest error {max((row['law_worst_m'] for row in rows), default=0.0):.2f} m"


if __name__ == "__main__":
    main()
