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
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
# One flight takes one core; the processes share them.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

import numpy as np  # noqa: E402
from flights.beside import Row, Task, flown  # noqa: E402
from flights.workers import in_processes  # noqa: E402
from support.catalogue.drawn import LEAST, MOST  # noqa: E402
from support.catalogue.vehicles import catalogue  # noqa: E402

PROCESSOR_S = 1800.0
"""Processor time the flights of one vehicle on one path may take."""
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
    """What was held, by state, beside the foils."""
    print(
        f"\n{'':8s}{'flights':>8s}{'held':>6s}{'by PID':>8s}{'off':>6s}{'largest error [m]: median':>28s}{'worst':>8s}"
    )
    for state in ("dead", "stuck"):
        some = [row for row in rows if row["state"] == state]
        if not some:
            continue
        held, pid, off = (
            sum(row.get(f"{name}_end_m", np.inf) <= 0.5 for row in some) for name in ("law", "pid", "off")
        )
        worst = [row["law_worst_m"] for row in some]
        print(f"{state:8s}{len(some):8d}{held:6d}{pid:8d}{off:6d}{np.median(worst):28.2f}{max(worst):8.1f}")


def _words(rows: list[Row]) -> str:
    held: Any = sum(row["held"] for row in rows)
    return f"{held} of {len(rows)} held, largest error {max((row['law_worst_m'] for row in rows), default=0.0):.2f} m"


if __name__ == "__main__":
    main()
