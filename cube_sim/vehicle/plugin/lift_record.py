"""The wrench of everything that lifts a hull, by its tables in a compiled model; for the compiled callbacks."""

from __future__ import annotations

import numba

from cube_sim.tuples import plus6
from cube_sim.vehicle.laws.body_lift import (
    PRODUCT_COLUMNS,
    STRIP_COLUMNS,
    deflected_wrench,
    products_wrench,
    strips_wrench,
)
from cube_sim.vehicle.laws.fin import COLUMNS, HULL, SERVO, fin_wrench
from cube_sim.vehicle.plugin.memory import double, matrix


@numba.njit
def fin_row(tables, fin):
    """The row of a fin, by its number among all of them, in the record at an address."""
    products, strips, fins = int(double(tables, 0)), int(double(tables, 1)), int(double(tables, 2))
    start = tables + 40 + 8 * (products * PRODUCT_COLUMNS + strips * STRIP_COLUMNS)
    return matrix(start, fins, COLUMNS)[fin]


@numba.njit
def lift_wrench(tables, hull, activations, nu_r):
    """The wrench of a hull's fins, velocity products and strips, a 6-tuple [N, N m], body axes.

    Args:
        tables: address of the record, see `cube_sim.vehicle.plugin.layout`.
        hull: number of the hull.
        activations: address of the model's activations.
        nu_r: relative velocity, a 6-tuple, body axes [m/s, rad/s].
    """
    products, strips, fins = int(double(tables, 0)), int(double(tables, 1)), int(double(tables, 2))
    linear, square = int(double(tables, 3)), int(double(tables, 4))
    start = tables + 40
    F = products_wrench(matrix(start, products, PRODUCT_COLUMNS), hull, nu_r)
    start += 8 * products * PRODUCT_COLUMNS
    if strips > 0:
        F = plus6(F, strips_wrench(matrix(start, strips, STRIP_COLUMNS), hull, nu_r))
    start += 8 * strips * STRIP_COLUMNS
    table = matrix(start, fins, COLUMNS)
    start += 8 * fins * COLUMNS
    by_deflection = matrix(start, linear, PRODUCT_COLUMNS)
    by_square = matrix(start + 8 * linear * PRODUCT_COLUMNS, square, PRODUCT_COLUMNS)
    for k in range(fins):
        if table[k, HULL] == hull:
            deflection, servo = 0.0, int(table[k, SERVO])
            if servo >= 0:
                deflection = double(activations, servo)
            F = plus6(F, fin_wrench(table[k], deflection, nu_r))
            if linear + square > 0:
                F = plus6(F, deflected_wrench(by_deflection, by_square, k, deflection, nu_r))
    return F
