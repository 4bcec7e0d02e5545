"""What a flight costs: microseconds per control period, as ratios within one run.

    python benchmarks/loop.py [--vehicles NAME ...] [--seconds S] [--rounds N] [--enumeration]
                              [--json FILE] [--plot FILE]

Variants of one scenario per vehicle, in turn, round by round, the floor before each of them. Processor time is that of
all threads together; ratios and real-time factors are those of the clock, as the flight, ProxQP and the view have
threads of their own: let the machine be idle. A round ends when every answer is confirmed.

    bare MuJoCo          the same model stepped alone, its commands constant: the floor
    plain Python         the foil: a PID to the next point of the path and a clipped pseudo-inverse, in plain numpy
    ticks in Python      the loop tick by tick: what own code in a scenario is flown by
    search               the loop, compiled where it can be, exact allocation, nothing recorded to a file
    search + ProxQP      and every answer confirmed
    enumeration          ProxQP asked for every subset instead, with --enumeration: seconds a tick
    MCAP                 search + ProxQP, the record written
    MCAP and Rerun       and its view: what `cube-sim run` does

A table of where the time of a tick in Python goes follows (search + ProxQP, by stage, the clock's own cost taken off).
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

import mujoco
import numpy as np

from cube_sim.errors import CubeSimError
from cube_sim.flight import Flight, Loop, tick
from cube_sim.flight import loop as flight_loop
from cube_sim.mission import prepare
from cube_sim.mission.run_header import header
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.rerun.sink import PIECE_S
from cube_sim.scenario import load

SCENARIOS = Path(__file__).parents[1] / "scenarios"
VEHICLES = {
    "cube": "cube_helix",
    "cube_navigated": "cube_navigated",
    "bluerov2_heavy": "bluerov2_free",
    "bluerov2_vectored": "bluerov2_vectored_helix",
    "jack": "jack_exact",
    "rov6": "rov6_helix",
    "torpedo": "torpedo_helix",
    "infante": "infante_line",
}
WARM_TICKS = 25
PAUSE_S = 0.05
"""For the view's thread to come to its end, between a variant and the next floor."""
ENUMERATED_TICKS = 2
"""Ticks with every subset asked for: thousands of problems each."""

Ticks = Callable[[int], None]


def settings(method: str, duration_s: float) -> dict[str, Any]:
    """Overrides: how long, and how wrenches are allocated."""
    checks = [{"kind": "allowed_forces"}]
    return {"duration_s": duration_s, "checks": checks, "events": [], "allocation.method": method}


def flying(flown: Loop, by_python: bool = False) -> Ticks:
    """As far as compiled code goes, or tick by tick in Python alone."""
    warnings: list[str] = []

    def ticks(count: int) -> None:
        end = flown.tick + count
        if not by_python:
            flown.go_on(count)
        while flown.tick < end:
            flown.control(warnings)
            flown.advance()
        flown.mission.allocator.settle()

    return ticks


def loop(scenario: Path, method: str, by_python: bool = False) -> Ticks:
    """The loop with rows in memory."""
    return flying(Flight(scenario, settings(method, 3600.0)), by_python)


def recorded(scenario: Path, folder: Path, view: bool) -> Ticks:
    """The loop with its rows going to files; a round begins and ends in the middle of a piece of the view."""
    loaded = load(scenario, settings("search+proxqp", 3600.0))
    mission = prepare(loaded)
    folder.mkdir()
    recorder = Recorder(folder, header(loaded), mission.channels, mission.model, view, mission.vehicle.name)
    ticks = flying(Loop(mission, recorder))
    ticks(round(0.5 * PIECE_S / mission.scenario.control_period_s))
    return ticks


def bare(scenario: Path) -> Ticks:
    """MuJoCo with its water and thrusters, and nobody who steers."""
    mission = prepare(load(scenario, settings("search", 3600.0)))
    model, data, steps = mission.model, mission.data, mission.scenario.steps_per_tick

    def ticks(count: int) -> None:
        for _ in range(count):
            mujoco.mj_step(model, data, nstep=steps)

    return ticks


def plain_python(scenario: Path) -> Ticks:
    """What one writes first: numpy, a PID on position and attitude, a pseudo-inverse, commands clipped."""
    mission = prepare(load(scenario, settings("search", 3600.0)))
    model, data, steps, vehicle = mission.model, mission.data, mission.scenario.steps_per_tick, mission.vehicle
    inverse, path, thrusters = np.linalg.pinv(vehicle.actuation_matrix), mission.path, vehicle.thrusters
    mass, dt = vehicle.mass, mission.scenario.control_period_s
    at, dof, body = vehicle.qpos_address, vehicle.dof_address, vehicle.body
    largest = thrusters.limits[:, 3]
    summed, s = np.zeros(3), 0.0

    def ticks(count: int) -> None:
        nonlocal s
        for _ in range(count):
            mujoco.mj_forward(model, data)
            s += 0.3 * dt
            R = data.xmat[body].reshape(3, 3)
            error = path.at(s).position - data.qpos[at : at + 3]
            summed[:] = np.clip(summed + dt * error, -1.0, 1.0)
            force = mass * (error - 1.5 * data.qvel[dof : dof + 3] + 0.2 * summed)
            torque = -mass * 0.1 * (R[2] @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]]) + data.qvel[dof + 3 : dof + 6])
            forces = inverse @ np.concatenate([R.T @ force, torque])
            data.ctrl[thrusters.actuators] = np.clip(forces / largest, -1.0, 1.0)
            mujoco.mj_step(model, data, nstep=steps)

    return ticks


def timed(ticks: Ticks, count: int) -> tuple[float, float]:
    """Microseconds per tick: of processor time, of all threads together; and of the clock."""
    processor, clock = time.process_time(), time.perf_counter()
    ticks(count)
    return (time.process_time() - processor) / count * 1e6, (time.perf_counter() - clock) / count * 1e6


def by_stage(scenario: Path, count: int) -> dict[str, float]:
    """Microseconds per tick in Python of each stage, from clocks around the functions of the loop."""
    spent: dict[str, float] = {}
    flown, warnings = Flight(scenario, settings("search+proxqp", 3600.0)), []
    mission = flown.mission
    clocked = [
        (flight_loop, "divergence", "is it a state"),
        (flown, "_feed_thrusters", "supply"),
        (flown._watches.surface, "note", "surface"),
        (flight_loop, "respond_to_faults", "fault finding"),
        (tick, "read_state", "state"),
        (mission.controller, "decide", "guidance and control"),
        (tick, "allocate_at", "allocation"),
        (tick, "_write", "rows"),
        (flown, "advance", "MuJoCo's steps"),
    ]
    if mission.estimation is not None:
        clocked.append((mission.estimation, "estimate", "navigation"))
    cost, originals = _clock_us(), []
    for owner, name, label in clocked:
        originals.append((owner, name, getattr(owner, name)))
        setattr(owner, name, _clocked(getattr(owner, name), label, spent, cost))
    try:
        for _ in range(WARM_TICKS):
            flown.control(warnings)
            flown.advance()
        spent.clear()
        started = time.perf_counter()
        for _ in range(count):
            flown.control(warnings)
            flown.advance()
        whole = (time.perf_counter() - started) * 1e6 - cost * count * len(clocked)
    finally:
        for owner, name, original in originals:
            setattr(owner, name, original)
    stages = {label: value / count for label, value in spent.items()}
    return stages | {"the rest": whole / count - sum(stages.values())}


def _clocked(function: Callable[..., Any], label: str, spent: dict[str, float], cost_us: float) -> Callable[..., Any]:
    def clocked(*arguments: Any) -> Any:
        started = time.perf_counter()
        result = function(*arguments)
        spent[label] = spent.get(label, 0.0) + (time.perf_counter() - started) * 1e6 - cost_us
        return result

    return clocked


def _clock_us() -> float:
    """What a clock around a function costs."""
    spent: dict[str, float] = {}
    nothing = _clocked(lambda: None, "", spent, 0.0)
    for _ in range(10_000):
        nothing()
    return spent[""] / 10_000


def measured(name: str, seconds: float, rounds: int, enumeration: bool, folder: Path) -> dict[str, Any]:
    """All variants of one vehicle: medians over the rounds."""
    scenario = SCENARIOS / f"{VEHICLES[name]}.yaml"
    period = load(scenario).scenario.control_period_s
    count = max(WARM_TICKS, round(seconds / period))
    variants = {
        "bare MuJoCo": bare(scenario),
        "plain Python": plain_python(scenario),
        "ticks in Python": loop(scenario, "search", by_python=True),
        "search": loop(scenario, "search"),
        "search + ProxQP": loop(scenario, "search+proxqp"),
        "MCAP": recorded(scenario, folder / f"{name}_mcap", view=False),
        "MCAP and Rerun": recorded(scenario, folder / f"{name}_both", view=True),
    }
    for ticks in variants.values():
        ticks(WARM_TICKS)
    times: dict[str, list[tuple[float, float]]] = {variant: [] for variant in variants}
    shares: dict[str, list[float]] = {variant: [] for variant in variants}
    for _ in range(rounds):
        for variant, ticks in variants.items():
            time.sleep(PAUSE_S)
            _, floor = timed(variants["bare MuJoCo"], count)  # at the same moment: others use the machine too
            times[variant].append(timed(ticks, count))
            shares[variant].append(floor / times[variant][-1][1])
    if enumeration:
        times["enumeration"] = [timed(loop(scenario, "enumerate"), ENUMERATED_TICKS)]
        shares["enumeration"] = [times["bare MuJoCo"][-1][1] / times["enumeration"][0][1]]
    processor, clock = (
        {variant: median(pair[k] for pair in pairs) for variant, pairs in times.items()} for k in (0, 1)
    )
    return {
        "scenario": scenario.stem,
        "period_us": period * 1e6,
        "tick_us": processor,
        "clock_us": clock,
        "of_bare": {variant: median(each) for variant, each in shares.items()},
        "of_bare_from_to": {variant: (min(each), max(each)) for variant, each in shares.items()},
        "real_time_factor": {variant: period * 1e6 / value for variant, value in clock.items()},
        "stages_us": by_stage(scenario, count),
    }


def report(results: dict[str, dict[str, Any]]) -> None:
    """Print the tables."""
    for name, result in results.items():
        print(f"\n{name} ({result['scenario']})")
        print(f"{'':24s}{'us a tick':>12s}{'by the clock':>14s}{'of bare MuJoCo':>24s}{'x real time':>14s}")
        for variant, value in result["tick_us"].items():
            clock, share = result["clock_us"][variant], result["of_bare"][variant]
            factor = result["real_time_factor"][variant]
            low, high = result["of_bare_from_to"][variant]
            print(f"{variant:24s}{value:12.1f}{clock:14.1f}{share:10.3f} ({low:.2f} to {high:.2f}){factor:13.0f}")
        print("  a tick in Python by stage:")
        for label, value in sorted(result["stages_us"].items(), key=lambda pair: -pair[1]):
            print(f"  {label:24s}{value:10.1f}")


def plot(results: dict[str, dict[str, Any]], file: Path) -> None:
    """Bars of the share of bare MuJoCo, one group a vehicle."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    variants = ["plain Python", "ticks in Python", "search", "search + ProxQP", "MCAP", "MCAP and Rerun"]
    figure, axes = plt.subplots(figsize=(4.0 + 1.2 * len(results), 4.0), layout="constrained")
    for i, variant in enumerate(variants):
        at = np.arange(len(results)) + (i - 2.5) * 0.14
        axes.bar(at, [result["of_bare"][variant] for result in results.values()], 0.13, label=variant)
    axes.set_xticks(range(len(results)), list(results))
    axes.set_ylabel("speed, of bare MuJoCo")
    axes.legend(ncols=3, fontsize="small")
    figure.savefig(file, dpi=120)


def main() -> None:
    """Measure and say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--vehicles", nargs="+", default=["cube"], metavar="NAME", help=f"of {', '.join(VEHICLES)}, or all"
    )
    pieces = f"simulated time of a round [s]; a multiple of {PIECE_S} has whole pieces of the view"
    parser.add_argument("--seconds", type=float, default=float(PIECE_S), help=pieces)
    parser.add_argument("--rounds", type=int, default=5, help="how often each variant takes its turn")
    parser.add_argument("--enumeration", action="store_true", help="also ask ProxQP for every subset")
    parser.add_argument("--json", type=Path, help="write the figures there")
    parser.add_argument("--plot", type=Path, help="write the picture there")
    arguments = parser.parse_args()
    if not arguments.seconds > 0.0 or arguments.rounds < 1:
        parser.error("--seconds must be positive, --rounds 1 at least")
    names = list(VEHICLES) if arguments.vehicles == ["all"] else arguments.vehicles
    for name in names:
        if name not in VEHICLES:
            parser.error(f"--vehicles {name}: no such vehicle; there are {', '.join(VEHICLES)}")
    try:
        with TemporaryDirectory() as folder:
            given = arguments.seconds, arguments.rounds, arguments.enumeration, Path(folder)
            results = {name: measured(name, *given) for name in names}
    except CubeSimError as error:
        sys.exit(str(error))
    report(results)
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2))
    if arguments.plot:
        plot(results, arguments.plot)


if __name__ == "__main__":
    main()
