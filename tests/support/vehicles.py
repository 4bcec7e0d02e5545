"""Vehicles the actuation tests share."""

from dataclasses import replace
from functools import cache

import numpy as np

from cube_sim import Vehicle, load_model
from cube_sim.spatial import quaternion_from_rotation, rotation_from_quaternion, skew
from cube_sim.vehicle.dynamics import Dynamics
from support.places import MODELS


@cache
def vehicle(name: str) -> Vehicle:
    return Vehicle.from_model(load_model(MODELS / f"{name}.xml"))


def cube() -> Vehicle:
    return vehicle("cube")


def random_hull(rng) -> Dynamics:
    """A hull of 10 N in water, 11 N of lift, with mass matrices that couple everything."""
    rigid, added = (G @ G.T + 3 * np.eye(6) for G in rng.normal(size=(2, 6, 6)))
    g = 10.0 / rigid[0, 0]
    return Dynamics(
        mass_matrix=rigid,
        added_mass=added,
        linear_damping=np.diag(rng.uniform(0.1, 2, 6)),
        quadratic_damping=np.diag(rng.uniform(0.1, 2, 6)),
        displaced_mass=11.0 / g,
        centre_of_mass=rng.normal(size=3) * 0.1,
        centre_of_buoyancy=rng.normal(size=3) * 0.1,
        gravity=np.array([0.0, 0.0, -g]),
    )


def weightless(mass_matrix, quadratic_damping=None) -> Dynamics:
    """A hull without weight, lift and linear drag."""
    none = np.zeros((6, 6))
    drag = none if quadratic_damping is None else quadratic_damping
    return Dynamics(mass_matrix, none, none, drag, 0.0, np.zeros(3), np.zeros(3), np.zeros(3))


def ballasted(hull: Dynamics, weight_N: float) -> Dynamics:
    """The hull with a point of this weight [N] at its centre of mass; its lift stays."""
    m = weight_N / np.linalg.norm(hull.gravity)
    S = skew(hull.centre_of_mass)
    return replace(hull, mass_matrix=hull.mass_matrix + m * np.block([[np.eye(3), -S], [S, -S @ S]]))


def steady_wrench(hull: Dynamics, nu, up):
    """(6,) what keeps nu (6,) steady in still water where world up is `up` (3,) in body axes: inverse dynamics."""
    across = np.linalg.svd(up[None])[2][1:]
    return hull.wrench(np.vstack([across, up]), nu, np.zeros(6), np.zeros(3))


def random_rotation(rng):
    q = rng.normal(size=4)
    return rotation_from_quaternion(q / np.linalg.norm(q))


def turned(R, theta):
    """R exp(S(theta)) for a small theta, orthonormal to rounding."""
    S = skew(theta)
    return rotation_from_quaternion(quaternion_from_rotation(R @ (np.eye(3) + S + S @ S / 2)))
