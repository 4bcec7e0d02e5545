"""Stability margins of the whole loop, controller, thrusters, hull and water, linearised for every vehicle.

    python benchmarks/margins.py
    python benchmarks/margins.py --vehicles cube "bluerov2*" --wrong one
    python benchmarks/margins.py --wrong all --jobs 2

Each vehicle of `tests/support/catalogue/vehicles.py` holds a point, and follows a level line at thirds of a speed: 0.6
of that which takes 60 % of the thrusters' force, or its critical speed where that is less. Where it is, the table has
the former, too. Speeds that the analysis does not call flyable are left out.

One tick of the real loop is differentiated about that steady motion: MuJoCo's hull, water and
lag of the thrusters, the controller's observers and the control period are in it; dead zones and limits are not. Then
it is opened where the wrench goes to the thrusters, in one direction at a time with the others closed.

`--wrong one` believes drag, added mass or thrust 30 % less and more, and a current that is 0.5 m/s off; `--wrong all`
also everything wrong at once. The critical speed is then the one up to which a vehicle is sure of its margins for all
that (`surely_uncritical_speed`). Printed is the worst of a vehicle and speed, and in the end the worst of all that fly
alike, and who has it; margins.csv has every row.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from fnmatch import fnmatchcase
from functools import partial
from itertools import product
from multiprocessing import get_context
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from closed_loop.condition import NOMINAL, WRONG, Condition, corners, one_at_a_time  # noqa: E402
from closed_loop.survey import SHARES, Row, surveyed  # noqa: E402
from support.catalogue.vehicles import catalogue  # noqa: E402

GAIN_DB, PHASE_DEG = 6.0, 40.0
"""Margins that are enough."""
OWN = ("HOLONOMIC", "LEVEL", "TRIM")
"""Ways of flying in which all forces are the vehicle's own; in the others the attitude points them."""
ALIKE: dict[str, Callable[[Row], bool]] = {
    "all forces its own, up to the critical speed": lambda row: row.authority in OWN and not row.beyond,
    "points its thrust, up to the critical speed": lambda row: row.authority not in OWN and not row.beyond,
    "beyond the critical speed": lambda row: row.beyond,
}


def main() -> None:
    """Look at all of them, print and write the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--vehicles", nargs="+", metavar="NAME", default=["*"], help="only these; * stands for anything"
    )
    parser.add_argument("--wrong", choices=("none", "one", "all"), default="none", help="what is known wrongly")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--out", type=Path, default=Path("logs/margins.csv"), help="the table")
    options = parser.parse_args()
    if options.jobs < 1:
        parser.error("--jobs must be 1 at least")
    names = [name for name in catalogue() if any(fnmatchcase(name, said) for said in options.vehicles)]
    if not names:
        parser.error(f"--vehicles {' '.join(options.vehicles)}: no such vehicle")
    conditions = [NOMINAL]
    if options.wrong != "none":
        conditions += one_at_a_time()
    if options.wrong == "all":
        conditions += corners()
    known_to = 0.0 if options.wrong == "none" else WRONG
    options.out.parent.mkdir(parents=True, exist_ok=True)
    every: list[Row] = []
    with (
        options.out.open("w", newline="") as file,
        ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool,
    ):
        writer = csv.writer(file)
        writer.writerow(Row._fields)
        print(f"{'vehicle':30s} {'m/s':>5s} flies      beyond stable  gain dB  phase deg  the worst when")
        for rows in pool.map(
            partial(_rows, conditions=conditions, known_to=known_to),
            product(names, SHARES),
        ):
            writer.writerows(rows)
            if rows:
                print(_line(rows), flush=True)
                every += rows
    print(f"\n{'':44s} looked at  stable  enough  least dB  least deg  of")
    for title, which in ALIKE.items():
        _print_worst(title, [row for row in every if which(row)])


def _print_worst(title: str, rows: list[Row]) -> None:
    """One line of the rows of a kind; those that find no steady motion are not stable."""
    rows = [row for row in rows if row.why in ("", "no steady motion")]
    stable = [row for row in rows if row.stable]
    enough = [row for row in stable if row.gain_db >= GAIN_DB and row.phase_deg >= PHASE_DEG]
    counts = f"{title:44s} {len(rows):9d}  {len(stable):6d}  {len(enough):6d}"
    if not stable:
        print(counts)
        return
    gain, phase = min(stable, key=lambda row: row.gain_db), min(stable, key=lambda row: row.phase_deg)
    of = dict.fromkeys(f"{row.vehicle} at {row.speed_m_s:.2f} m/s, {row.words}" for row in (gain, phase))
    print(f"{counts}  {gain.gain_db:8.1f}  {phase.phase_deg:9.0f}  {'; '.join(of)}")


def _rows(job: tuple[str, float], conditions: list[Condition], known_to: float) -> list[Row]:
    name, share = job
    return surveyed(catalogue()[name], share, conditions, known_to)


def _line(rows: list[Row]) -> str:
    head = f"{rows[0].vehicle:30s} {rows[0].speed_m_s:5.2f}"
    known = [row for row in rows if not row.why]
    if not known:
        return f"{head} {rows[0].authority:10s} {rows[0].why[:100]}"
    least = min(known, key=lambda row: row.phase_deg)
    odd = [row.words for row in rows if row.why]
    beyond, stable = "yes" if least.beyond else "", "yes" if all(row.stable for row in known) else "NO"
    return (
        f"{head} {least.authority:10s} {beyond:6s} {stable:6s}"
        f"  {min(row.gain_db for row in known):7.1f}  {least.phase_deg:9.0f}  {least.words}"
        + (f"; no steady motion: {len(odd)}" if odd else "")
    )


if __name__ == "__main__":
    main()
