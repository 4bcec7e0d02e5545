"""What a mission is about: the vehicle, the kind of path and the ingredients, drawn from its seed alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from support.catalogue.vehicles import PLANAR, Entry, catalogue

from flights.paths import PATHS

INGREDIENTS = (
    "current",
    "sheared",
    "attitude",
    "knowledge",
    "navigation",
    "fault",
    "allocator",
    "misbuilt",
    "tick",
)
"""What may be added to a path, a speed and an initial error."""

KINDS = ("plain", *INGREDIENTS[:-1], "mixed")
"""A mission adds one ingredient, none (plain), or each with a chance of 0.4 (mixed)."""

LEAST_FOR_A_LOSS = 6
"""Thrusters a vehicle has at least for a mission to take one away; fewer are weakened only."""


@dataclass(frozen=True)
class Plan:
    """A mission in outline.

    Attributes:
        seed: of everything in it.
        vehicle: its name in the catalogue.
        kind: one of `KINDS`.
        path: one of `flights.paths.PATHS`.
        ingredients: what it adds.
    """

    seed: int
    vehicle: str
    kind: str
    path: str
    ingredients: tuple[str, ...]


def stream(seed: int, use: str) -> np.random.Generator:
    """Random numbers of one use: what is drawn for another does not move with it."""
    return np.random.default_rng([12, seed, *use.encode()])


def drawn_plan(seed: int) -> Plan:
    """The mission of a seed, whatever others are flown."""
    rng = stream(seed, "plan")
    kind = str(rng.choice(KINDS))
    group = _groups()[int(rng.choice(4, p=[0.3, 0.35, 0.25, 0.1]))]
    entry = group[int(rng.integers(len(group)))]
    path = str(rng.choice(PATHS))
    chosen = {kind} if kind in INGREDIENTS else set()
    if kind == "mixed":
        chosen = {name for name in INGREDIENTS if rng.random() < 0.4}
    if "sheared" in chosen:
        chosen -= {"current"}
    if entry.lost:
        chosen -= {"fault"}
    if entry.name.startswith("infante"):
        chosen -= {"attitude", "allocator", "tick"}  # the planar law has one of each
        path = str(rng.choice(("line", "circle", "sinusoid", "spline", "polyline", "arc")))
    return Plan(seed, entry.name, kind, path, tuple(name for name in INGREDIENTS if name in chosen))


def _groups() -> tuple[list[Entry], ...]:
    """Ours, other people's, drawn ones, and those with losses."""
    everything = list(catalogue().values())
    whole = [e for e in everything if not e.lost]
    ours = [e for e in whole if e.name in ("cube", "cube_as_built", "bluerov2_heavy", *PLANAR)]
    drawn = [e for e in whole if e.name.startswith("drawn")]
    others = [e for e in whole if e not in ours and e not in drawn]
    return ours, others, drawn, [e for e in everything if e.lost]
