"""Vehicles the actuation tests share."""

from functools import cache

import numpy as np

from cube_sim import Vehicle, load_model
from cube_sim.actuation.hull import Hull


@cache
def cube() -> Vehicle:
    return Vehicle.from_model(load_model("models/cube.xml"))


def hull_of(vehicle: Vehicle) -> Hull:
    g = float(np.linalg.norm(vehicle.gravity))
    return Hull(
        mass=vehicle.mass_matrix + vehicle.added_mass,
        linear_damping=vehicle.linear_damping,
        quadratic_damping=vehicle.quadratic_damping,
        weight=vehicle.mass * g,
        buoyancy=vehicle.displaced_mass * g,
        centre_of_mass=vehicle.centre_of_mass,
        centre_of_buoyancy=vehicle.centre_of_buoyancy,
    )


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
