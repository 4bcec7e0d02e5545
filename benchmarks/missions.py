"""Fly many missions, drawn by seed over all vehicles, and compare them with what the analysis says beforehand.

    python benchmarks/missions.py --count 60 --jobs 2
    python benchmarks/missions.py --only 17 --keep
    python benchmarks/missions.py --catalogue

A mission is a vehicle of `tests/support/catalogue/vehicles.py`, a path of some kind, a speed and an initial error, and
one ingredient or several: current, sheared current, another attitude, knowledge that is wrong, navigation, faults,
another allocator, a vehicle that is not built as drawn, another control period. All of it comes from the mission's seed
alone, so a mission is the same whatever is flown beside it. It passes when its cross-track RMS on the true state, after
it should have converged, is at most 5 cm, or on the navigation estimate three standard deviations of its own; when the
target moves on; and when no whole thruster is ever doubted.

`--catalogue` flies each vehicle on a level line, at a point and on a helix instead: the analysis says yes if and only
if it flies.

Writes missions.csv, missions.json and missions.png, or catalogue.csv and catalogue.json; of each mission the files that
`cube-sim run` takes.
"""

from __future__ import annotations

import argparse
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

from flights import flight, picture, sweep, tables  # noqa: E402
from flights.plan import KINDS, Plan, drawn_plan  # noqa: E402
from flights.workers import in_processes  # noqa: E402
from support.catalogue.vehicles import catalogue  # noqa: E402

PROCESSOR_S = 600.0
"""Processor time a flight may take: by enumeration it solves 81 problems a tick, 350,000 in 87 s, at half a ms each."""
WALL = 20.0
"""Seconds of the clock for one of processor time: what a crowded machine may take."""


def main() -> None:
    """Fly, and write the tables and the picture."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=60, help="how many missions")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first; the others follow")
    parser.add_argument("--only", type=int, nargs="+", metavar="SEED", help="fly these alone, whatever they are")
    parser.add_argument("--vehicles", nargs="+", metavar="NAME", help="only these, or those that begin so with NAME*")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, help="only missions of these kinds")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="flights at a time")
    parser.add_argument(
        "--timeout", type=float, default=PROCESSOR_S, help="processor time [s] of a flight; more is given up"
    )
    parser.add_argument("--out", type=Path, default=Path("logs/missions"), help="folder for tables, picture, scenarios")
    parser.add_argument("--all", action="store_true", help="fly also what the analysis says no to")
    parser.add_argument("--keep", action="store_true", help="keep the recordings; the default with --only")
    parser.add_argument("--list", action="store_true", help="say what the vehicles or missions are, and fly nothing")
    parser.add_argument("--catalogue", action="store_true", help="fly every vehicle on three paths instead")
    arguments = parser.parse_args()
    if arguments.count < 1 or arguments.jobs < 1:
        parser.error("--count and --jobs must be 1 at least")
    if arguments.seed < 0 or min(arguments.only or [0]) < 0:
        parser.error("seeds must be 0 at least")
    if not arguments.timeout > 0.0:
        parser.error("--timeout must be positive")
    vehicles = _vehicles(parser, arguments.vehicles)
    arguments.out.mkdir(parents=True, exist_ok=True)
    # The processes of the flights end with this one, also when it is told to.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    if arguments.catalogue:
        fly_catalogue(vehicles, arguments)
    else:
        fly_missions(plans(vehicles, arguments), arguments)


def plans(vehicles: set[str], arguments: argparse.Namespace) -> list[Plan]:
    """The missions asked for: those of the seeds from the first on that are of such a kind and vehicle."""
    if arguments.only:
        return [drawn_plan(seed) for seed in arguments.only]
    kinds, found, seed = set(arguments.kinds or KINDS), [], arguments.seed
    while len(found) < arguments.count:
        plan = drawn_plan(seed)
        if plan.vehicle in vehicles and plan.kind in kinds:
            found.append(plan)
        seed += 1
        if seed - arguments.seed > 10_000 + 100 * arguments.count:
            break
    return found


def fly_missions(every: list[Plan], arguments: argparse.Namespace) -> None:
    """Fly them and show what became of them."""
    if arguments.list:
        for plan in every:
            print(f"{plan.seed:6d}  {plan.vehicle:32s} {plan.kind:10s} {plan.path:9s} {' '.join(plan.ingredients)}")
        return
    keep = arguments.keep or bool(arguments.only)
    rows: list[dict[str, Any]] = [{} for _ in every]
    started = time.perf_counter()
    calls = [
        (_mission, plan, arguments.out / "missions", arguments.all or bool(arguments.only), keep) for plan in every
    ]
    for index, row in _flights(calls, arguments):
        plan = every[index]
        about = {"seed": plan.seed, "vehicle": plan.vehicle, "kind": plan.kind, "path": plan.path}
        rows[index] = about | {"ingredients": plan.ingredients} | row
        print(f"{plan.seed:6d}  {plan.vehicle:32s} {plan.kind:10s} {plan.path:9s} {_words(rows[index])}", flush=True)
        # After each, so that a campaign that is ended leaves what it has flown.
        tables.write([r for r in rows if r], arguments.out, "missions")
    picture.draw(rows, arguments.out / "missions.png")
    tables.print_missions(rows)
    print(f"{time.perf_counter() - started:.0f} s; tables, picture and scenarios: {arguments.out}")


def fly_catalogue(vehicles: set[str], arguments: argparse.Namespace) -> None:
    """Fly every vehicle on three paths, and list where the analysis and the flights disagree."""
    names = [name for name in catalogue() if name in vehicles]
    if arguments.list:
        print("\n".join(names))
        return
    pairs = [(name, path) for name in names for path in sweep.FLIGHTS]
    started, rows = time.perf_counter(), [{} for _ in pairs]
    calls = [(_swept, name, path, arguments.out / "catalogue", arguments.keep) for name, path in pairs]
    for index, row in _flights(calls, arguments):
        name, path = pairs[index]
        rows[index] = {"vehicle": name, "path": path} | row
        if row.get("asked", True):
            print(f"{name:32s} {path:9s} {_words(rows[index])}", flush=True)
        tables.write([r for r in rows if r], arguments.out, "catalogue")
    found = sweep.verdicts(rows)
    print(f"\n{'vehicle':32s} {'says':5s} {'flies':6s} what came of each path")
    for name, says, flies, came, reason in found:
        mark = "" if says == flies else "   <- disagree" + ("" if says else f": {reason[:90]}")
        print(f"{name:32s} {'yes' if says else 'no':5s} {'yes' if flies else 'no':6s} {came}{mark}")
    agree = sum(says == flies for _, says, flies, _, _ in found)
    alarms = sum(int(row.get("false_alarms") or 0) for row in rows)
    print(f"\n{agree} of {len(found)} vehicles as the analysis says; {alarms} false fault alarms")
    print(f"{time.perf_counter() - started:.0f} s; tables and scenarios: {arguments.out}")


def _flights(calls: list[tuple], arguments: argparse.Namespace):
    for index, good, value in in_processes(
        _call, calls, jobs=arguments.jobs, cpu_s=arguments.timeout, wall_s=WALL * arguments.timeout
    ):
        yield index, value if good else {"flown": True, "forecast": True, "passes": False, "cause": str(value)}


def _call(function, *arguments):
    return function(*arguments)


def _mission(plan: Plan, out: Path, flown_anyway: bool, keep: bool):
    return flight.flown(plan, out, flown_anyway=flown_anyway, keep=keep)


def _swept(vehicle: str, path: str, out: Path, keep: bool):
    return sweep.swept(vehicle, path, out, keep)


def _words(row: dict[str, Any]) -> str:
    """The outcome of a flight in a few words."""
    expected = "yes" if row.get("forecast") else "no"
    if not row.get("flown"):
        return f"{expected:4s} not flown: {row.get('forecast_reason', '')[:80]}"
    rms = row.get("rms_m")
    figure = "        -" if rms is None else f"{100.0 * rms:6.1f} cm"
    return f"{expected:4s} {figure}  {row.get('cause') or 'ok'}"


def _vehicles(parser: argparse.ArgumentParser, asked: list[str] | None) -> set[str]:
    """Names of the catalogue that are asked for."""
    every, found = list(catalogue()), set()
    for name in asked or ["*"]:
        some = {n for n in every if n == name or (name.endswith("*") and n.startswith(name[:-1]))}
        if not some:
            parser.error(f"--vehicles {name}: no such vehicle; --catalogue --list says which there are")
        found |= some
    return found


if __name__ == "__main__":
    main()
