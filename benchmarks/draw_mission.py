"""What the samples of missions.yaml, catalogue.yaml and pairs.yaml fly, beside what the analysis says of it beforehand.

A mission is a vehicle of `tests/support/catalogue/vehicles.py`, a path of some kind, a speed and an initial error, and
one ingredient or several: current, sheared current, another attitude, knowledge that is wrong, navigation, faults,
another allocator, a vehicle that is not built as drawn, another control period. All of it comes from the mission's seed
alone, so a mission is the same whatever is flown beside it. It is judged once it should have converged.

A trial is a vehicle on a level line, at a point or on a helix, in still water: it is to fly if and only if the analysis
says so. Beside the catalogue there are trials of vehicles that their fins steer
(`tests/support/catalogue/steered.py`).
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import count, islice
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(folder) for folder in (HERE, HERE.parent / "tests") if str(folder) not in sys.path]

from flights.mission import written  # noqa: E402
from flights.plan import KINDS, Plan, drawn_plan  # noqa: E402
from flights.sampled import Sample, sampled  # noqa: E402
from flights.trial import every_vehicle, line_without, pairs, trial_of, trials  # noqa: E402
from support.catalogue.vehicles import catalogue  # noqa: E402

FILES = HERE.parent / "logs" / "drawn"
"""Where models and tables of points stand, for each mission in a folder of its own."""
SEARCHED = 10_000
"""So many seeds in a row without a mission of the kinds and vehicles asked for are enough."""


def mission(
    k: int, rng: np.random.Generator, first_seed: int = 0, vehicles: Sequence[str] = (), kinds: Sequence[str] = ()
) -> Sample:
    """The mission of the k-th seed from the first on whose vehicle and kind are asked for.

    Args:
        k: number of the sample.
        rng: not used: a seed is the same mission in every campaign.
        first_seed: at least 0.
        vehicles: names, or their beginnings with a * behind; none for all.
        kinds: some of `flights.plan.KINDS`; none for all.
    """
    if unknown := set(kinds) - set(KINDS):
        raise ValueError(f"no kind {min(unknown)}; there are {', '.join(KINDS)}")
    plan = next(islice(_plans(first_seed, named(vehicles), frozenset(kinds or KINDS)), k, None))
    return sampled(written(plan, FILES / f"mission_{plan.seed}"))


def trial(k: int, rng: np.random.Generator, vehicles: Sequence[str] = ()) -> Sample:
    """The k-th of all pairs of a vehicle and a path that it is asked for.

    Args:
        k: number of the sample.
        rng: not used: nothing is drawn.
        vehicles: as for `mission`.
    """
    every = _trials(named(vehicles, every_vehicle()))
    if k >= len(every):
        raise ValueError(f"there are {len(every)} trials of these vehicles: samples.count")
    vehicle, path = every[k]
    return sampled(trial_of(vehicle, path, FILES / f"trial_{vehicle}_{path}"))


def without_two(
    k: int, rng: np.random.Generator, vehicles: Sequence[str] = (), speed_m_s: float | None = None
) -> Sample:
    """The k-th of all vehicles without two of their thrusters, on a level line.

    Args:
        k: number of the sample.
        rng: not used: nothing is drawn.
        vehicles: names of the catalogue, or "fresh<m>_<seed>" for layouts of m thrusters drawn by another seed.
        speed_m_s: along the line; by default half of what the thrusters left make, 0.1 to 0.4.
    """
    every = _pairs(tuple(vehicles))
    if k >= len(every):
        raise ValueError(f"there are {len(every)} pairs of these vehicles: samples.count")
    vehicle, lost = every[k]
    return sampled(line_without(vehicle, lost, speed_m_s, FILES / f"pair_{vehicle}"))


def named(asked: Sequence[str], among: Iterable[str] | None = None) -> tuple[str, ...]:
    """Names that are asked for, of the catalogue or among others."""
    every, found = list(catalogue() if among is None else among), set()
    for name in [asked] if isinstance(asked, str) else asked or ["*"]:
        some = {n for n in every if n == name or (name.endswith("*") and n.startswith(name[:-1]))}
        if not some:
            raise ValueError(f"no vehicle {name}; the catalogue has {', '.join(every)}")
        found |= some
    return tuple(name for name in every if name in found)


def _plans(first_seed: int, vehicles: tuple[str, ...], kinds: frozenset[str]) -> Iterator[Plan]:
    last = first_seed
    for seed in count(first_seed):
        plan = _plan(seed)
        if plan.vehicle in vehicles and plan.kind in kinds:
            yield plan
            last = seed
        elif seed - last > SEARCHED:
            raise ValueError(f"none of the {SEARCHED} seeds from {last} on is a mission of these vehicles and kinds")


_plan = cache(drawn_plan)


@cache
def _pairs(vehicles: tuple[str, ...]) -> list[tuple[str, tuple[str, ...]]]:
    return pairs(vehicles, FILES)


@cache
def _trials(vehicles: tuple[str, ...]) -> list[tuple[str, str]]:
    return trials(vehicles, FILES)
