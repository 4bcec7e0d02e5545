"""Ballast by its record in a compiled model: what a hull gets of it, and its inertia; for the compiled callbacks."""

from __future__ import annotations

import numba

from cube_sim.vehicle.laws.ballast import COLUMNS, DENSITY, HULL, STATE, tank_inertia
from cube_sim.vehicle.plugin.memory import double, matrix, put


@numba.njit
def ballast_rows(record):
    """The rows (n, `COLUMNS`) of the record at an address."""
    return matrix(record + 8, int(double(record, 0)), COLUMNS)


@numba.njit
def with_tanks(rows, hull, activations, added, room):
    """Address of added mass (6,6) and that of the tanks of a hull together: where they are alone, or in the room.

    Args:
        rows: of `ballast_rows`.
        hull: number of the hull.
        activations: address of the model's activations.
        added: address of M_A (6,6).
        room: address of room for as many.
    """
    found = False
    for k in range(rows.shape[0]):
        row = rows[k]
        if row[HULL] == hull and row[DENSITY] > 0.0:
            volume = double(activations, int(row[STATE]))
            for i in range(6):
                for j in range(6):
                    before = double(room if found else added, 6 * i + j)
                    put(room, 6 * i + j, before + tank_inertia(row, volume, i, j))
            found = True
    return room if found else added
