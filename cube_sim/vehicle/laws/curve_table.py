"""The characteristics of all thrusters of a hull in one array, and what compiled laws read off it.

Per thruster, from its start: c_DZ-, c_DZ+, F_DZ-, F_DZ+ [N], n, how many points the reverse side has, the first point
of the forward side, c_1..c_n, F_1..F_n [N]. The laws are those of `cube_sim.vehicle.characteristic`.
"""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.laws.thrust_law import force_of_command, interpolate

HEADER = 7


def curve_table(curves: tuple[Characteristic, ...]) -> tuple[np.ndarray, np.ndarray]:
    """The table (k,) of m characteristics and where each of them starts, (m,) int."""
    records, starts, end = [np.zeros(0)], [], 0
    for curve in curves:
        (reverse, _), (forward, _) = curve.sides
        n = len(curve.commands)
        head = *curve.command_dead_zone, *curve.force_dead_zone, n, len(reverse), n - len(forward)
        records.append(np.concatenate([head, curve.commands, curve.forces]))
        starts.append(end)
        end += records[-1].size
    return np.concatenate(records), np.array(starts, dtype=np.int64)


@compiled
def steady_forces(table, starts, commands):
    """Steady forces (m,) [N] of commands (m,)."""
    forces = np.empty(len(starts))
    for i in range(len(starts)):
        a = starts[i]
        n, first = int(table[a + 4]), a + HEADER
        points, values = table[first : first + n], table[first + n : first + 2 * n]
        forces[i] = force_of_command(commands[i], table[a], table[a + 1], points, values)
    return forces


@compiled
def commands_of_forces(table, starts, forces):
    """Commands (m,) whose steady forces are these (m,) [N]; see `Characteristic.command`."""
    commands = np.empty(len(starts))
    for i in range(len(starts)):
        a, force = starts[i], forces[i]
        n, first = int(table[a + 4]), a + HEADER
        reverse, forward = int(table[a + 5]), int(table[a + 6])
        points, values = table[first : first + n], table[first + n : first + 2 * n]
        commands[i] = 0.0
        if force > 0.0 and force >= 0.5 * table[a + 3]:
            beyond = np.nextafter(table[a + 1], np.inf)
            commands[i] = max(interpolate(force, values[forward:], points[forward:]), beyond)
        elif force < 0.0 and force <= 0.5 * table[a + 2]:
            beyond = np.nextafter(table[a], -np.inf)
            commands[i] = min(interpolate(force, values[:reverse], points[:reverse]), beyond)
    return commands


@compiled
def drawn_power(packed, efficiency_at, stuck_at, coefficients, forces):
    """Electrical power (m,) [W] of thrusters whose propellers may be damaged: k_P |F|^1.5 of healthy propellers.

    Args:
        packed: the model's own numbers, see `cube_sim.vehicle.plugin.layout`.
        efficiency_at: (m,) where in them the efficiencies are.
        stuck_at: (m,) where the forces of stuck thrusters are.
        coefficients: (m,2) k_P-, k_P+ [W/N^1.5].
        forces: (m,) [N] that the thrusters give.
    """
    power = np.empty(len(forces))
    for i in range(len(forces)):
        force = forces[i]
        if np.isnan(packed[stuck_at[i]]):
            efficiency = packed[efficiency_at[i]]
            force = force / efficiency if efficiency > 0.0 else 0.0
        k = coefficients[i, 0] if force < 0.0 else coefficients[i, 1]
        power[i] = k * abs(force) ** 1.5
    return power
