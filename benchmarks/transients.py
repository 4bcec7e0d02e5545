"""Fly faults of thrusters and hold against each flight what its log said of it: how far it leaves its path.

    python benchmarks/transients.py --draws 300 --out logs/transients
    python benchmarks/transients.py --draws 100 --seed 5000 --only PLANE LINE

Each mission is drawn by its seed alone (`flights/faulted.py`): a vehicle of the catalogue or a layout drawn anew, a
path, a current, an attitude, a control period of 10 to 100 ms, sensors, knowledge that is wrong; and one thruster dead,
weak or stuck, two of them five seconds apart, or one weak and one stuck at once. What the log says when a fault is
found holds until the next one is, or for as long as it looks ahead.

Writes transients.json, and says of each authority how near the forecasts came, and which flights went beyond.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

import numpy as np  # noqa: E402
from flights.faulted import Row, said_and_flown  # noqa: E402
from flights.workers import in_processes  # noqa: E402

PROCESSOR_S = 600.0
"""Processor time a mission may take."""
NEAR_M = 0.01
"""Nearer to its path than this, ratios say nothing."""


def main() -> None:
    """Fly, and write the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--draws", type=int, default=100, help="so many missions")
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="flights at a time")
    parser.add_argument("--only", nargs="+", default=[], metavar="AUTHORITY", help="of these alone say what is far off")
    parser.add_argument("--out", type=Path, default=Path("logs/transients"), help="folder for the table and the models")
    arguments = parser.parse_args()
    if arguments.jobs < 1 or arguments.draws < 1 or arguments.seed < 0:
        parser.error("--jobs and --draws must be 1 at least, --seed 0")
    arguments.out.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    started, rows, failed = time.perf_counter(), [], 0
    calls = [(seed, arguments.out / "models") for seed in range(arguments.seed, arguments.seed + arguments.draws)]
    for index, good, value in in_processes(
        said_and_flown, calls, jobs=arguments.jobs, cpu_s=PROCESSOR_S, wall_s=20.0 * PROCESSOR_S
    ):
        if not good:
            failed += 1
            print(f"{calls[index][0]}: {value}", flush=True)
            continue
        rows += value
        (arguments.out / "transients.json").write_text(json.dumps(rows, indent=1, default=float))
    print_summary(rows, arguments.only)
    print(f"{failed} missions not flown; {time.perf_counter() - started:.0f} s; table and models: {arguments.out}")


def print_summary(rows: list[Row], only: list[str]) -> None:
    """How near each kind of forecast came, and what went beyond it."""
    head = f"{'':12s}{'said of':>8s}{'bounded':>8s}{'beyond':>7s}"
    print(head + f"{'foreseen/flown':>26s}{'said/flown':>11s}{'flown [m]':>18s}")
    print(f"{'':35s}{'5 %':>10s}{'median':>8s}{'95 %':>8s}{'median':>11s}{'median':>9s}{'most':>9s}")
    for authority in sorted({row["authority"] for row in rows}):
        some = [row for row in rows if row["authority"] == authority]
        told = [row for row in some if row["at_most_m"] is not None]
        beyond, bounded = sum(row["beyond"] for row in told), sum(row["bounded"] for row in told)
        far = [row for row in told if row["flown_m"] > NEAR_M and not row["navigated"]]
        flown = [row["flown_m"] for row in some]
        nearness, looseness = ([row[key] / row["flown_m"] for row in far] for key in ("foreseen_m", "at_most_m"))
        head = f"{authority:12s}{len(told):4d}/{len(some):<3d}{bounded:8d}{beyond:7d}"
        ratios = [*np.percentile(nearness, [5, 50, 95]), np.median(looseness)] if far else [np.nan] * 4
        print(head + "{:10.2f}{:8.2f}{:8.2f}{:11.1f}".format(*ratios), f"{np.median(flown):8.3f}{max(flown):9.2f}")
    for row in rows:
        if row["beyond"]:
            print(f"BEYOND: {_words(row)}")
    for row in rows:
        if row["authority"] in only and row["flown_m"] > 0.5:
            print(f"far: {_words(row)}")


def _words(row: Row) -> str:
    how = ", ".join(key for key in ("navigated", "known_wrongly", "bounded") if row[key])
    return (
        f"{row['seed']} {row['vehicle']} {row['path']}, {row['mode']}, {row['period_s']:g} s, {how}: "
        f"{row['flown_m']:.3f} m; {row['said']}"
    )


if __name__ == "__main__":
    main()
