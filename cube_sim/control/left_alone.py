"""Where a hull is carried whose thrusters are all off but those that are stuck, by its equations of motion.

Pushed by one thruster it may come to rest against the water, tilted; or it turns round and round, so that the push
leads nowhere. No balance of forces tells which.
"""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Record, Vector
from cube_sim.tuples import length, minus6, put_matrix, rotated, sextuple, times, to_world, triple
from cube_sim.vehicle.laws.hull_motion import inverse_dynamics

STEP_S = 0.02
"""Of the integration."""
FASTEST = 20.0
"""A hull that moves faster [m/s, rad/s] has left what can be integrated so: it is carried off."""


def carried_m(hull: Record, held: Vector, rotation: Matrix, nu: Vector, current_W: Vector, seconds: int) -> Vector:
    """The largest distance from where it is now [m] within each of so many seconds, (seconds,).

    Args:
        hull: record of `cube_sim.vehicle.laws.hull_motion.HULL`.
        held: wrench (6,) of the thrusters that are stuck [N, N m].
        rotation: R_WB (3,3) now.
        nu: velocity over ground and rates (6,) now, body axes [m/s, rad/s].
        current_W: (3,) [m/s], world axes.
        seconds: how far to look.
    """
    farthest, mobility = np.full(seconds, np.inf), np.linalg.inv(hull["total_mass"][0])
    steps = round(1.0 / STEP_S)
    _carry(hull, mobility, held, np.array(rotation), np.array(nu, dtype=np.float64), current_W, steps, farthest)
    return farthest


@compiled
def _carry(hull, mobility, held, R, nu, current_W, steps, farthest):
    """Fill the largest distances [m] of each so many steps, by the midpoint rule; R and nu are moved on."""
    place, most = np.zeros(3), 0.0
    current, push = triple(current_W), sextuple(held)
    still, middle = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), np.empty(6)
    for k in range(len(farthest)):
        for _ in range(steps):
            missing = minus6(push, inverse_dynamics(hull, R, sextuple(nu), still, current))
            for i in range(6):
                middle[i] = nu[i]
                for j in range(6):
                    middle[i] += 0.5 * STEP_S * mobility[i, j] * missing[j]
            missing = minus6(push, inverse_dynamics(hull, R, sextuple(middle), still, current))
            for i in range(6):
                for j in range(6):
                    nu[i] += STEP_S * mobility[i, j] * missing[j]
            if not gone_on(R, place, nu, STEP_S):
                return
            most = max(most, length(triple(place)))
        farthest[k] = most


@compiled
def gone_on(R, place, nu, step_s):
    """Move a place (3,) [m] and an attitude R_WB (3,3) by a velocity for a step; whether what becomes of it is told.

    Faster than `FASTEST` nothing is moved any more.
    """
    velocity, rates = to_world(R, triple(nu)), triple(nu[3:])
    spin = length(rates)
    if not (length(velocity) < FASTEST and spin < FASTEST):
        return False
    for i in range(3):
        place[i] += step_s * velocity[i]
    if spin > 0.0:
        put_matrix(R, rotated(R, times(1.0 / spin, rates), spin * step_s))
    return True
