"""Other numbers for a vehicle: its file compiled each time, against a copy of one compiled model that gets them.

    python benchmarks/model_parameters.py [--scenario FILE] [--samples N] [--rounds N]

    model     the compiled model alone
    flight    a flight made ready, as each of `cube_sim.fly_many` and of a sweep is
    reset     of a vector environment with two flights, both drawn anew

Both ways take turns in one run, on the same drawn numbers. Times are those of the clock, medians of the rounds.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import cube_sim
from cube_sim.errors import CubeSimError
from cube_sim.gym import make_vec
from cube_sim.mission import prepare
from cube_sim.scenario import load
from cube_sim.scenario.loading import loaded_again
from cube_sim.scenario.shared import Shared
from cube_sim.vehicle.compiled_once import CompiledOnce
from cube_sim.vehicle.vehicle import hull_names

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cube_helix.yaml"


def drawn(nominal: dict[str, np.ndarray], samples: int) -> list[dict[str, list[float]]]:
    """So many sets of parameters, each up to 5 % off."""
    rng = np.random.default_rng(0)
    return [
        {name: (values * rng.uniform(0.95, 1.05)).tolist() for name, values in nominal.items()} for _ in range(samples)
    ]


def seconds_each(function: Callable[[Any], Any], things: list[Any]) -> float:
    """Of the clock, for one of them."""
    started = time.perf_counter()
    for thing in things:
        function(thing)
    return (time.perf_counter() - started) / len(things)


def main() -> None:
    """Measure and say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--scenario", type=Path, default=SCENARIO, help="what is flown")
    parser.add_argument("--samples", type=int, default=20, help="how many sets of numbers")
    parser.add_argument("--rounds", type=int, default=3, help="how often each takes its turn")
    arguments = parser.parse_args()
    if arguments.samples < 1 or arguments.rounds < 1:
        parser.error("--samples and --rounds must be 1 at least")
    try:
        rows = compared(load(arguments.scenario), arguments.samples, arguments.rounds)
    except CubeSimError as error:
        sys.exit(str(error))
    print(f"{arguments.samples} sets of numbers for the vehicle of {arguments.scenario.stem}, ms each")
    print(f"{'':10s}{'compiled':>10s}{'copied':>10s}{'ratio':>8s}")
    for name, (compiled, copied) in rows.items():
        ratio = median(a / b for a, b in zip(compiled, copied, strict=True))
        print(f"{name:10s}{1e3 * median(compiled):10.1f}{1e3 * median(copied):10.1f}{ratio:8.2f}")


def compared(loaded: Any, samples: int, rounds: int) -> dict[str, tuple[list[float], list[float]]]:
    """Seconds of each round, both ways."""
    file, given = loaded.scenario.model, dict(loaded.scenario.parameters)
    model = cube_sim.load_model(file, given)
    hull = loaded.scenario.vehicle or hull_names(model)[0]
    varied = [f"{hull}:added_mass", f"{hull}:quadratic_damping", f"{hull}:mass"]
    nominal = {name: np.array(model.numeric(name).data) for name in varied[:2]}
    nominal[varied[2]] = np.array(model.body(hull).mass)
    sets = drawn(nominal, samples)
    once, share = CompiledOnce.of(file, {**given, **sets[0]}), Shared()
    flights = [loaded_again(loaded, {f"parameters.{name}": values for name, values in each.items()}) for each in sets]
    factors = {"model": dict.fromkeys(varied, (0.95, 1.05))}
    alone, together = make_vec(loaded, 2, randomise=factors), make_vec(loaded, 2, randomise=factors)
    for env in alone.envs:
        env.unwrapped._loaded = replace(env.unwrapped._loaded, shared=None)
    ways: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any], list[Any]]] = {
        "model": (
            lambda each: cube_sim.load_model(file, {**given, **each}),
            lambda each: once.with_parameters({**given, **each}),
            sets,
        ),
        "flight": (prepare, lambda each: prepare(replace(each, shared=share)), flights),
        "reset": (lambda seed: alone.reset(seed=seed), lambda seed: together.reset(seed=seed), list(range(samples))),
    }
    spent: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in ways}
    for turn in range(rounds + 1):
        for name, (compiled, copied, things) in ways.items():
            both = seconds_each(compiled, things), seconds_each(copied, things)
            if turn:  # the first one warms up
                for kept, value in zip(spent[name], both, strict=True):
                    kept.append(value)
    return spent


if __name__ == "__main__":
    main()
