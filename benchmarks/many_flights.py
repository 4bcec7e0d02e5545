"""Many flights at once against the same flights one by one, in one run.

    python benchmarks/many_flights.py [--scenario FILE] [--flights N] [--seconds S] [--threads T] [--rounds N]

    ticks in Python      one flight, tick by tick in the interpreter: what a loop of one's own over `Flight` costs
    one by one           `Flight` after `Flight`, each flown as far as compiled code goes
    bare, 1 thread       the same model stepped alone for as long, its commands constant: the floor
    bare, T threads
    fly_many, 1 thread   the same flights, preparation and checks included
    fly_many, T threads

Each flight has a current of its own. The exact search allocates; nothing is written. Times are those of the clock, so
let the machine be idle.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median
from typing import Any

import mujoco
import numpy as np

import cube_sim
from cube_sim.errors import CubeSimError
from cube_sim.flight import Flight
from cube_sim.mission import prepare
from cube_sim.scenario import load

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cube_helix.yaml"
PYTHON_SECONDS = 5.0
"""How long the flight in Python is flown."""


def variations(count: int, seconds: float) -> list[dict[str, Any]]:
    """So many flights, each in a current of its own."""
    random = np.random.default_rng(0)
    checks = [{"kind": "allowed_forces"}]
    common = {"duration_s": seconds, "checks": checks, "events": [], "allocation.method": "search"}
    return [common | {"current_m_s": random.uniform(-0.1, 0.1, 3).tolist()} for _ in range(count)]


def in_python(scenario: Path, varied: list[dict[str, Any]]) -> float:
    """Seconds that one flight of `varied` takes in the interpreter, after preparation."""
    flight, warnings = Flight(scenario, varied[0]), []
    share = min(1.0, PYTHON_SECONDS / varied[0]["duration_s"])
    started = time.perf_counter()
    for _ in range(round(share * flight.mission.scenario.ticks)):
        flight.control(warnings)
        flight.advance()
    return (time.perf_counter() - started) / share


def one_by_one(scenario: Path, varied: list[dict[str, Any]]) -> None:
    """Prepare and fly each."""
    for variation in varied:
        Flight(scenario, variation).fly_to_its_end()


def bare(scenario: Path, varied: list[dict[str, Any]], threads: int) -> None:
    """MuJoCo with its water and thrusters for as long, and nobody who steers."""
    mission = prepare(load(scenario, varied[0]))
    model, steps = mission.model, round(varied[0]["duration_s"] / mission.model.opt.timestep)
    with ThreadPoolExecutor(threads) as pool:  # MuJoCo lets other threads go on
        list(pool.map(lambda _: mujoco.mj_step(model, mujoco.MjData(model), nstep=steps), varied))


def timed(function: Callable[[], Any]) -> float:
    """Seconds of the clock."""
    started = time.perf_counter()
    function()
    return time.perf_counter() - started


def main() -> None:
    """Measure and say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--scenario", type=Path, default=SCENARIO, help="what is flown")
    parser.add_argument("--flights", type=int, default=40, help="how many")
    parser.add_argument("--seconds", type=float, default=60.0, help="simulated time of each [s]")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1, help="how many at a time")
    parser.add_argument("--rounds", type=int, default=3, help="how often each takes its turn")
    arguments = parser.parse_args()
    if arguments.flights < 1 or arguments.threads < 1 or arguments.rounds < 1 or not arguments.seconds > 0.0:
        parser.error("--flights, --threads and --rounds must be 1 at least, --seconds positive")
    scenario, varied = arguments.scenario, variations(arguments.flights, arguments.seconds)
    several = f"fly_many, {arguments.threads} threads"
    ways: dict[str, Callable[[], Any]] = {
        "one by one": lambda: one_by_one(scenario, varied),
        "bare, 1 thread": lambda: bare(scenario, varied, 1),
        f"bare, {arguments.threads} threads": lambda: bare(scenario, varied, arguments.threads),
        "fly_many, 1 thread": lambda: cube_sim.fly_many(scenario, varied, threads=1),
        several: lambda: cube_sim.fly_many(scenario, varied, threads=arguments.threads),
    }
    try:
        cube_sim.fly_many(scenario, varied[:1], threads=1)
        spent: dict[str, list[float]] = {name: [] for name in ("ticks in Python", *ways)}
        for _ in range(arguments.rounds):
            spent["ticks in Python"].append(arguments.flights * in_python(scenario, varied))
            for name, way in ways.items():
                spent[name].append(timed(way))
    except CubeSimError as error:
        sys.exit(str(error))
    seconds = {name: median(values) for name, values in spent.items()}
    against_one = median(a / b for a, b in zip(spent["fly_many, 1 thread"], spent[several], strict=True))
    floor = {name: spent[name.replace("fly_many", "bare")] for name in ("fly_many, 1 thread", several)}
    simulated = arguments.flights * arguments.seconds
    print(f"{arguments.flights} flights of {arguments.seconds:g} s of {scenario.stem}")
    print(f"{'':24s}{'s':>10s}{'x real time':>14s}{'x ticks in Python':>20s}")
    for name, value in seconds.items():
        print(f"{name:24s}{value:10.2f}{simulated / value:14.0f}{seconds['ticks in Python'] / value:20.1f}")
    print(f"{arguments.threads} threads against one: {against_one:.2f}")
    for name, times in floor.items():
        print(f"{name}, of bare MuJoCo: {median(a / b for a, b in zip(times, spent[name], strict=True)):.2f}")


if __name__ == "__main__":
    main()
