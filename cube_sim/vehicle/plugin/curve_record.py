"""The steady force of a thruster by its record in a compiled model; for the compiled callbacks."""

from __future__ import annotations

import numba

from cube_sim.vehicle.laws.thrust_law import between
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.memory import double


@numba.njit
def steady_force(command, curve):
    """`cube_sim.vehicle.laws.thrust_law.force_of_command` [N] by the curve record at an address.

    An index of an array may count from its end, which is looked at each time; a place in memory may not.

    Args:
        command: normalised command after the motor's lag.
        curve: address of the record.
    """
    if double(curve, layout.DEAD_LOW) <= command <= double(curve, layout.DEAD_HIGH):
        return 0.0
    n = int(double(curve, layout.POINTS))
    xs = curve + 8 * layout.CURVE
    ys = xs + 8 * n
    if command <= double(xs, 0):
        return double(ys, 0)
    if command >= double(xs, n - 1):
        return double(ys, n - 1)
    low, high = 0, n - 1
    while high - low > 1:
        middle = (low + high) >> 1
        if double(xs, middle) <= command:
            low = middle
        else:
            high = middle
    return between(command, double(xs, low), double(xs, high), double(ys, low), double(ys, high))
