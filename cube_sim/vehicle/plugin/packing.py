"""Where the water's parameters lie inside a compiled model.

`load_model` appends one custom numeric, `PACKED`, as the last of the model: an array the compiled callback can read
without names, locks or state, and that travels with every copy of the model into threads, processes and files.

    [MAGIC, number of hulls, start of hull records, start of the actuator table, start of the current or -1, process]
    hull records, HULL_SIZE each
    actuator table: one entry per actuator, the start of its curve record or -1
    curve records: [c_DZ-, c_DZ+, F_DZ-, F_DZ+, n, efficiency, supply, stuck, k_P-, k_P+, voltage,
                    pulse of -1, of 0, of 1, c_1..c_n, F_1..F_n]; voltage and pulses are NaN where not known
    current: [n_t, n_z, t_1.., z_1.., (v_x, v_y, v_z) time by time]

A few entries are meant to change while a model is in use: `cube_sim.vehicle.faults`.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.vehicle.mjcf.parameters import CurrentProfile, Hull, ThrusterParameters, WaterParameters

PACKED = "cube_sim:packed"
MAGIC = -7.390851332151607e-137  # nobody's physical value; the callback's test for "one of ours"

# the header
COUNT, HULLS, ACTUATORS, CURRENT, PROCESS = 1, 2, 3, 4, 5
HEADER_SIZE = 6
# one hull record
BODY, DOF, DISPLACED_MASS, CENTRE, ADDED_MASS, LINEAR, QUADRATIC, FORCE = 0, 1, 2, 3, 6, 42, 78, 114
HULL_SIZE = 115
# one curve record
DEAD_LOW, DEAD_HIGH, ZONE_LOW, ZONE_HIGH, POINTS = 0, 1, 2, 3, 4
EFFICIENCY, SUPPLY, STUCK, POWER, VOLTAGE, PULSE, CURVE = 5, 6, 7, 8, 10, 11, 14


def pack(
    parameters: WaterParameters, bodies: list[int], dofs: list[int], forces: Sequence[int], process: float
) -> NDArray[np.float64]:
    """Lay the parameters out as the callback reads them.

    Args:
        parameters: what the MJCF says, validated.
        bodies: body index of each hull in the compiled model.
        dofs: address of each hull's first degree of freedom.
        forces: place of each hull's own force in the table of this process, or -1.
        process: number of this process.
    """
    hulls = [_hull_record(*row) for row in zip(parameters.hulls, bodies, dofs, forces, strict=True)]
    table_start = HEADER_SIZE + HULL_SIZE * len(hulls)
    end = table_start + len(parameters.thrusters)
    table: list[float] = []
    curves: list[NDArray[np.float64]] = []
    for thruster in parameters.thrusters:
        if thruster is None:
            table.append(-1.0)
            continue
        table.append(float(end))
        curves.append(_curve_record(thruster))
        end += curves[-1].size
    current = _current_record(parameters.current)
    header = np.array([MAGIC, len(hulls), HEADER_SIZE, table_start, end if current.size else -1.0, process])
    return np.concatenate([header, *hulls, np.array(table), *curves, current])


def packed_size(parameters: WaterParameters) -> int:
    """Number of values `pack` will return."""
    n = len(parameters.hulls)
    return pack(parameters, [0] * n, [0] * n, [-1] * n, 0.0).size


def numbers(model: mujoco.MjModel) -> NDArray[np.float64]:
    """The packed parameters of a compiled model, a view to read and write.

    Raises:
        ModelError: the model has none.
    """
    if model.nnumeric:
        start = model.numeric_adr[model.nnumeric - 1]
        packed = model.numeric_data[start : start + model.numeric_size[model.nnumeric - 1]]
        if packed[0] == MAGIC:
            return packed
    raise ModelError("", "the model has no water; compile it with cube_sim.load_model")


def _hull_record(hull: Hull, body: int, dof: int, force: int) -> NDArray[np.float64]:
    record = np.empty(HULL_SIZE)
    record[BODY], record[DOF], record[DISPLACED_MASS] = body, dof, hull.displaced_mass
    record[CENTRE:ADDED_MASS] = hull.centre_of_buoyancy
    record[ADDED_MASS:LINEAR] = hull.added_mass.ravel()
    record[LINEAR:QUADRATIC] = hull.linear_damping.ravel()
    record[QUADRATIC:FORCE] = hull.quadratic_damping.ravel()
    record[FORCE] = force
    return record


def _curve_record(thruster: ThrusterParameters) -> NDArray[np.float64]:
    curve = thruster.characteristic
    whole = (1.0, 1.0, np.nan)  # efficiency, supply, not stuck
    head = [*curve.command_dead_zone, *curve.force_dead_zone, curve.commands.size, *whole, *thruster.power]
    wires = [np.nan if thruster.voltage is None else thruster.voltage, *(thruster.pulse_us or [np.nan] * 3)]
    return np.concatenate([np.array([*head, *wires]), curve.commands, curve.forces])


def _current_record(profile: CurrentProfile | None) -> NDArray[np.float64]:
    if profile is None:
        return np.empty(0)
    sizes = np.array([profile.times_s.size, profile.heights.size], dtype=float)
    return np.concatenate([sizes, profile.times_s, profile.heights, profile.velocities.ravel()])
