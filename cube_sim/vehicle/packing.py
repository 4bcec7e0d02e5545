"""Where the water's parameters lie inside a compiled model.

`load_model` appends one custom numeric, `PACKED`, as the last of the model: an array the compiled callback can read
without names, locks or state, and that travels with every copy of the model into threads, processes and files.

    [MAGIC, number of hulls, start of hull records, start of the actuator table]
    hull records, HULL_SIZE each
    actuator table: one entry per actuator, the start of its curve record or -1
    curve records: [c_DZ-, c_DZ+, F_DZ-, F_DZ+, n, c_1..c_n, F_1..F_n]
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.parameters import Hull, WaterParameters

PACKED = "cube_sim:packed"
MAGIC = -7.390851332151607e-137  # nobody's physical value; the callback's test for "one of ours"

# the header
COUNT, HULLS, ACTUATORS = 1, 2, 3
HEADER_SIZE = 4
# one hull record
BODY, DOF, DISPLACED_MASS, CENTRE, ADDED_MASS, LINEAR, QUADRATIC = 0, 1, 2, 3, 6, 42, 78
HULL_SIZE = 114
# one curve record
DEAD_LOW, DEAD_HIGH, ZONE_LOW, ZONE_HIGH, POINTS, CURVE = 0, 1, 2, 3, 4, 5


def pack(parameters: WaterParameters, bodies: list[int], dofs: list[int]) -> NDArray[np.float64]:
    """Lay the parameters out as the callback reads them.

    Args:
        parameters: what the MJCF says, validated.
        bodies: body index of each hull in the compiled model.
        dofs: address of each hull's first degree of freedom.
    """
    hulls = [_hull_record(hull, body, dof) for hull, body, dof in zip(parameters.hulls, bodies, dofs, strict=True)]
    table_start = HEADER_SIZE + HULL_SIZE * len(hulls)
    end = table_start + len(parameters.characteristics)
    table: list[float] = []
    curves: list[NDArray[np.float64]] = []
    for characteristic in parameters.characteristics:
        if characteristic is None:
            table.append(-1.0)
            continue
        table.append(float(end))
        curves.append(_curve_record(characteristic))
        end += curves[-1].size
    header = np.array([MAGIC, len(hulls), HEADER_SIZE, table_start])
    return np.concatenate([header, *hulls, np.array(table), *curves])


def packed_size(parameters: WaterParameters) -> int:
    """Number of values `pack` will return."""
    n = len(parameters.hulls)
    return pack(parameters, [0] * n, [0] * n).size


def _hull_record(hull: Hull, body: int, dof: int) -> NDArray[np.float64]:
    record = np.empty(HULL_SIZE)
    record[BODY], record[DOF], record[DISPLACED_MASS] = body, dof, hull.displaced_mass
    record[CENTRE:ADDED_MASS] = hull.centre_of_buoyancy
    record[ADDED_MASS:LINEAR] = hull.added_mass.ravel()
    record[LINEAR:QUADRATIC] = hull.linear_damping.ravel()
    record[QUADRATIC:] = hull.quadratic_damping.ravel()
    return record


def _curve_record(curve: Characteristic) -> NDArray[np.float64]:
    head = np.array([*curve.command_dead_zone, *curve.force_dead_zone, curve.commands.size])
    return np.concatenate([head, curve.commands, curve.forces])
