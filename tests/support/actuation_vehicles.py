"""Vehicles the actuation tests share."""

from functools import cache
from pathlib import Path

import numpy as np

from cube_sim import Vehicle, load_model
from cube_sim.actuation.path_following.hull import Hull
from cube_sim.commands.analysis_report import hull_of

__all__ = ["cube", "hull_of", "random_hull", "vehicle"]


@cache
def vehicle(name: str) -> Vehicle:
    return Vehicle.from_model(load_model(Path(__file__).parents[2] / "models" / f"{name}.xml"))


def cube() -> Vehicle:
    return vehicle("cube")


def random_hull(rng) -> Hull:
    G = rng.normal(size=(6, 6))
    return Hull(
        mass=G @ G.T + 6 * np.eye(6),
        linear_damping=np.diag(rng.uniform(0.1, 2, 6)),
        quadratic_damping=np.diag(rng.uniform(0.1, 2, 6)),
        weight=10.0,
        buoyancy=11.0,
        centre_of_mass=rng.normal(size=3) * 0.1,
        centre_of_buoyancy=rng.normal(size=3) * 0.1,
    )
