"""What propellers draw, by the torque on their shafts; plain Python, compiled.

With Q the torque that the water takes and w = 2 pi n, a propeller whose speed follows its command draws

    P = Q w / eta,

eta the share that its drive lets arrive at the shaft. One with a motor draws what goes into that, at its voltage U:

    P = U I,  I = (U - K w) / R,

which is Q w, friction, what speeds the shaft up, and R I^2. Neither gives anything back: where the water drives it, it
draws nothing (a choice).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.tuples import to_body
from cube_sim.vehicle.laws.propeller import (
    DRIVE,
    MOTOR,
    PLACE,
    RESISTANCE,
    TWO_PI,
    VOLTAGE,
    load_torque,
    motor_torque,
    open_water,
    rotation,
    rotation_of,
    speed_of_advance,
)
from cube_sim.vehicle.laws.surface import share_of_depth


class DrivenPropellers(NamedTuple):
    """The m thrusters of a hull, as far as torques on shafts say what they draw.

    Attributes:
        draws: (m,) whether they say it of each.
        rows: (m, 31) as `cube_sim.vehicle.laws.propeller` has them; zero for others.
        points: (k,) their open-water points.
        states: (m,) where their rotors' states lie among the activations.
        commands: (m,) where their lagged commands do, which is the voltage of a motor.
        radii: (m,) of their sites [m].
        surface: height of the water's [m].
        advance: (m,) speeds of advance [m/s]; moved on.
        wet: (m,) shares under water; moved on.
    """

    draws: NDArray[np.bool_]
    rows: Matrix
    points: Vector
    states: NDArray[np.int64]
    commands: NDArray[np.int64]
    radii: Vector
    surface: float
    advance: Vector
    wet: Vector


@compiled
def power_of_rotation(row, points, n, u_a, volts, wet):
    """Electrical power [W] of a propeller.

    Args:
        row: (`COLUMNS`,) of `cube_sim.vehicle.laws.propeller`.
        points: numbers in which its open-water points lie.
        n: speed of rotation [rev/s].
        u_a: speed of advance [m/s].
        volts: at its motor [V], where it has one.
        wet: share of it that is under water.
    """
    if row[MOTOR] > 0.0:
        return max(volts * motor_torque(row, n, volts) / row[MOTOR], 0.0)
    return max(wet * open_water(row, points, n, u_a)[1] * TWO_PI * n, 0.0) / row[DRIVE]


@compiled
def power_of_force(row, points, force, u_a, wet):
    """Electrical power [W] of a propeller that steadily gives a force [N] under water; else as `power_of_rotation`."""
    n, volts = rotation_of(row, points, force, u_a), 0.0
    if row[MOTOR] > 0.0:
        volts = row[MOTOR] * TWO_PI * n + row[RESISTANCE] / row[MOTOR] * load_torque(row, points, n, u_a)
    return power_of_rotation(row, points, n, u_a, volts, wet)


@compiled
def feel_flow(driven, state, water):
    """Move speeds of advance and shares under water on.

    Args:
        driven: `DrivenPropellers`.
        state: (22,) of `cube_sim.vehicle.state.hull_state`.
        water: (3,) its velocity where the hull is [m/s], world axes.
    """
    R = state[7:16].reshape(3, 3)
    flow = to_body(R, (water[0], water[1], water[2]))
    nu_r = state[16] - flow[0], state[17] - flow[1], state[18] - flow[2], state[19], state[20], state[21]
    for i in range(len(driven.draws)):
        if driven.draws[i]:
            row = driven.rows[i]
            driven.advance[i] = speed_of_advance(row, nu_r)
            height = state[2] + R[2, 0] * row[PLACE] + R[2, 1] * row[PLACE + 1] + R[2, 2] * row[PLACE + 2]
            depth = driven.surface - height
            driven.wet[i] = share_of_depth(depth, driven.radii[i]) if depth < driven.radii[i] else 1.0


@compiled
def power_of_propeller(driven, i, activations, efficiency, stuck, share):
    """Electrical power [W] of the i-th thruster, which torques tell; damaged it draws what a whole one does.

    Args:
        driven: `DrivenPropellers`, felt.
        i: which of them.
        activations: MuJoCo's.
        efficiency: true share of its force that it gives; 0 of a dead motor, which draws nothing.
        stuck: force that it gives whatever its command [N], at the nominal voltage; NaN of one that is free.
        share: (V / V_n)^2 of the voltage that feeds it.
    """
    row, ratio = driven.rows[i], sqrt(share)
    if not np.isnan(stuck):
        return power_of_force(row, driven.points, share * stuck, driven.advance[i], driven.wet[i])
    if efficiency <= 0.0:
        return 0.0
    n = rotation(row, activations[driven.states[i]], ratio)
    volts = activations[driven.commands[i]] * row[VOLTAGE] * ratio
    return power_of_rotation(row, driven.points, n, driven.advance[i], volts, driven.wet[i])


@compiled
def put_propellers_power(driven, activations, packed, efficiency_at, stuck_at, supply_at, power):
    """Put what propellers draw into the power (m,) [W] of all thrusters.

    Args:
        driven: `DrivenPropellers`, felt.
        activations: MuJoCo's.
        packed: the model's own numbers, see `cube_sim.vehicle.plugin.layout`.
        efficiency_at: (m,) where in them the efficiencies are.
        stuck_at: (m,) where the forces of stuck thrusters are.
        supply_at: (m,) where the shares of force are that the supply leaves.
        power: (m,) [W], changed.
    """
    for i in range(len(power)):
        if driven.draws[i]:
            health = packed[efficiency_at[i]], packed[stuck_at[i]]
            power[i] = power_of_propeller(driven, i, activations, health[0], health[1], packed[supply_at[i]])
