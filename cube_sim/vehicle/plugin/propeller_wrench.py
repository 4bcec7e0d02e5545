"""Propellers by their record in a compiled model: what a hull gets of them; for the compiled callbacks."""

from __future__ import annotations

from math import sqrt

import numba

from cube_sim.vehicle.laws.propeller import (
    ARM,
    COLUMNS,
    DELIVERED,
    HAND,
    open_water,
    rotation,
    speed_of_advance,
    thrust_at,
)
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.memory import double, matrix, vector


@numba.njit
def table_of(propellers):
    """The rows (n, `COLUMNS`) of the record at an address, and its open-water points (k,)."""
    n, k = int(double(propellers, 0)), int(double(propellers, 1))
    return matrix(propellers + 16, n, COLUMNS), vector(propellers + 8 * (2 + n * COLUMNS), k)


@numba.njit
def propeller_force(row, points, curve, state, nu_r):
    """Force on the hull of a propeller that is not stuck [N], its health and voltage counted in.

    Args:
        row: of the table.
        points: of it.
        curve: address of its curve record.
        state: of its rotor, a lagged command.
        nu_r: velocity of the hull through the water, a 6-tuple, body axes [m/s, rad/s].
    """
    n = rotation(row, state, sqrt(double(curve, layout.SUPPLY)))
    return double(curve, layout.EFFICIENCY) * thrust_at(row, points, n, speed_of_advance(row, nu_r))


@numba.njit
def unheld_torque(row, points, curve, state, nu_r):
    """Torque on the hull about the axis [N m] beside what MuJoCo makes of the thrust by the gear.

    A damaged propeller takes the torque of a whole one; a dead motor's stands. Arguments as in `propeller_force`.
    """
    efficiency, stuck = double(curve, layout.EFFICIENCY), double(curve, layout.STUCK)
    if row[HAND] == 0.0 or efficiency == 0.0 or stuck == stuck:
        return 0.0
    n = rotation(row, state, sqrt(double(curve, layout.SUPPLY)))
    thrust, torque = open_water(row, points, n, speed_of_advance(row, nu_r))
    return -row[HAND] * torque - row[ARM] * efficiency * row[DELIVERED] * thrust
