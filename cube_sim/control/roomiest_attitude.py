"""An attitude in which the thrusters have enough, found among attitudes spread evenly over all there are.

A thruster that is stuck pushes along one axis of the hull. Against it the others may have too little in one attitude
and enough in another, where weight, lift and drag take a share. To turn down the slope of what is short ends in the
first hollow; so all attitudes are looked at once.
"""

from __future__ import annotations

from functools import cache
from math import pi, sqrt

import numpy as np

from cube_sim.control.pace import Facets, facet_excess
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, Vector, rotation_from_quaternion
from cube_sim.tuples import to_body, triple
from cube_sim.vehicle.laws.hull_motion import steady_wrench

ATTITUDES = 1200
"""How many are looked at: none is farther than 20 degrees from one of them."""
TO_SPARE = 0.02
"""Share of a thruster set's mean facet by which an attitude has to be inside, to count as one with enough."""
TO_BRAKE = 0.1
"""The same for one to turn to, if there are any: what is to spare there brakes the hull."""


def roomiest_attitude(hull: Record, facets: Facets, force_ratio: float, flow_W: Vector, near: Matrix) -> Matrix | None:
    """The attitude (3,3) nearest to one in which the thrusters can keep a motion steady.

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        facets: of what the thrusters can make.
        force_ratio: share of their force that the supply leaves the thrusters.
        flow_W: velocity through the water to be kept (3,) [m/s], world axes.
        near: R_WB (3,3).

    Returns:
        None where they can in the present one, and where they can in none.
    """
    beyond = excesses(hull, *facets, force_ratio, flow_W, np.concatenate([near[None], spread_attitudes()]))
    enough = beyond <= _spare(facets)
    if enough[0] or not enough.any():
        return None
    roomy = beyond <= _spare(facets, TO_BRAKE)
    enough = roomy if roomy.any() else enough
    closeness = np.einsum("kij,ij->k", spread_attitudes(), near)
    return spread_attitudes()[int(np.argmax(np.where(enough[1:], closeness, -np.inf)))]


def has_enough(
    hull: Record, facets: Facets, force_ratio: float, flow_W: Vector, attitude: Matrix, to_spare: float = TO_SPARE
) -> bool:
    """Whether the thrusters can keep a motion steady in an attitude (3,3), with so much to spare; else as above."""
    return bool(excesses(hull, *facets, force_ratio, flow_W, attitude[None])[0] <= _spare(facets, to_spare))


def has_enough_somewhere(hull: Record, facets: Facets, force_ratio: float, flow_W: Vector, near: Matrix) -> bool:
    """Whether there is any attitude in which the thrusters can keep a motion steady; arguments as above."""
    attitudes = np.concatenate([near[None], spread_attitudes()])
    return bool(np.any(excesses(hull, *facets, force_ratio, flow_W, attitudes) <= 0.0))


def _spare(facets: Facets, share: float = TO_SPARE) -> float:
    return -share * float(np.mean(facets[1])) if len(facets[1]) else 0.0


@compiled
def excess(hull, normals, bounds, held_shares, force_ratio, flow, R):
    """How far the steady wrench lies beyond what is attainable, at its worst facet, in one attitude (3,3) [N]."""
    wrench = steady_wrench(hull, to_body(R, flow), (R[2, 0], R[2, 1], R[2, 2]))
    most = -np.inf
    for i in range(len(bounds)):
        most = max(most, facet_excess(normals, bounds, held_shares, force_ratio, i, wrench))
    return most


@compiled
def excesses(hull, normals, bounds, held_shares, force_ratio, flow_W, attitudes):
    """The same in attitudes (k,3,3): (k,) [N]."""
    result = np.empty(len(attitudes))
    flow = triple(flow_W)
    for k in range(len(attitudes)):
        result[k] = excess(hull, normals, bounds, held_shares, force_ratio, flow, attitudes[k])
    return result


@cache
def spread_attitudes() -> Matrix:
    """Attitudes (k,3,3) spread evenly by super-Fibonacci spirals (M. Alexa, CVPR 2022)."""
    phi, psi = sqrt(2.0), 1.533751168755204288118041
    s = np.arange(ATTITUDES) + 0.5
    t = s / ATTITUDES
    r, R = np.sqrt(t), np.sqrt(1.0 - t)
    alpha, beta = 2.0 * pi * s / phi, 2.0 * pi * s / psi
    quaternions = np.column_stack([R * np.cos(beta), r * np.sin(alpha), r * np.cos(alpha), R * np.sin(beta)])
    return np.array([rotation_from_quaternion(q) for q in quaternions])
