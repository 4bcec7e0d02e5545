"""What the thrusters of a hull can hold in the inflow and at the voltage of the moment, compiled.

A propeller's force depends on both, so its limits and the commands for a force follow them from tick to tick. Of a
thruster that has a curve alone, forces go with the share of them that the supply leaves.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector
from cube_sim.tuples import to_body
from cube_sim.vehicle.laws.curve_table import commands_of_forces, steady_forces
from cube_sim.vehicle.laws.propeller import (
    ADVANCE,
    held_forces,
    rotation,
    speed_of_advance,
    state_of_force,
    thrust_at,
)

FLOW_UNKNOWN_M_S = 0.5
"""By how much the current at a propeller may be other than estimated (a choice): to its force that much is no fault."""


class Inflow(NamedTuple):
    """The m thrusters of a hull as the moment has them.

    Attributes:
        varies: whether what they can hold depends on more than the supply's share of the force.
        turns: (m,) whether each is a propeller in its inflow.
        rows: (m, 31) of the propellers, see `cube_sim.vehicle.laws.propeller`; zero for others.
        points: (k,) their open-water points.
        known: (m,) whether the curves of each follow the voltage by themselves, forces and all.
        curves: table of `cube_sim.vehicle.laws.curve_table`, of the moment; like the next.
        starts: (m,) of it.
        nominal: (m,4) limits of those that are no propellers, by these curves [N].
        advance: (m,) speeds of advance [m/s]; moved on.
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N]; moved on.
    """

    varies: bool
    turns: np.ndarray
    rows: Matrix
    points: Vector
    known: np.ndarray
    curves: Vector
    starts: np.ndarray
    nominal: Matrix
    advance: Vector
    limits: Matrix


@compiled
def feel_inflow(inflow, R, v, w, current_W, share):
    """Move limits and speeds of advance on.

    Args:
        inflow: `Inflow`.
        R: R_WB (3,3).
        v: over ground (3,) [m/s], body axes.
        w: (3,) [rad/s], body axes.
        current_W: (3,) [m/s], world axes.
        share: of its force at the nominal voltage that the supply leaves a thruster that stands still.
    """
    flow, ratio = to_body(R, (current_W[0], current_W[1], current_W[2])), sqrt(share)
    nu_r = (v[0] - flow[0], v[1] - flow[1], v[2] - flow[2], w[0], w[1], w[2])
    for i in range(len(inflow.advance)):
        if inflow.turns[i]:
            inflow.advance[i] = speed_of_advance(inflow.rows[i], nu_r)
            held = held_forces(inflow.rows[i], inflow.points, inflow.advance[i], ratio)
            inflow.limits[i, 0], inflow.limits[i, 1] = held[0], held[1]
            inflow.limits[i, 2], inflow.limits[i, 3] = held[2], held[3]
        else:
            left = 1.0 if inflow.known[i] else share
            for side in range(4):
                inflow.limits[i, side] = left * inflow.nominal[i, side]


@compiled
def commands_in_flow(inflow, share, forces):
    """Commands (m,) that hold forces (m,) [N]; the nearest to one that is beyond the limits or in a dead zone.

    Args:
        inflow: `Inflow`, felt.
        share: of `feel_inflow`, above 0.
        forces: (m,) [N].
    """
    asked = forces.copy()
    for i in range(len(forces)):
        if not inflow.known[i]:
            asked[i] = forces[i] / share
    commands = commands_of_forces(inflow.curves, inflow.starts, asked)
    for i in range(len(forces)):
        if inflow.turns[i]:
            row, u_a = inflow.rows[i], inflow.advance[i]
            commands[i] = state_of_force(row, inflow.points, forces[i], u_a, sqrt(share))
    return commands


@compiled
def whole_forces(inflow, share, commands, measured, efficiency):
    """Steady forces (m,) [N] that whole thrusters make of commands (m,), as what is measured (m,) [N] leaves it open.

    The flow at a propeller is known as well as the current is, which is estimated. As long as it is believed whole
    (efficiency (m,) 1), what it would give in a flow slower or faster by `FLOW_UNKNOWN_M_S` at most is taken for what a
    whole one gives. Other forces are held against that of the flow as it is estimated. The other arguments are those of
    `commands_in_flow`.
    """
    forces = forces_in_flow(inflow, share, commands)
    for i in range(len(commands)):
        if inflow.turns[i] and efficiency[i] == 1.0:
            row, u_a = inflow.rows[i], inflow.advance[i]
            n, off = rotation(row, commands[i], sqrt(share)), row[ADVANCE] * FLOW_UNKNOWN_M_S
            slower, faster = thrust_at(row, inflow.points, n, u_a - off), thrust_at(row, inflow.points, n, u_a + off)
            if min(slower, faster) <= measured[i] <= max(slower, faster):
                forces[i] = measured[i]
    return forces


@compiled
def forces_in_flow(inflow, share, commands):
    """Steady forces (m,) [N] of commands (m,); the other arguments as in `commands_in_flow`."""
    forces = steady_forces(inflow.curves, inflow.starts, commands)
    for i in range(len(commands)):
        if not inflow.known[i]:
            forces[i] *= share
        if inflow.turns[i]:
            n = rotation(inflow.rows[i], commands[i], sqrt(share))
            forces[i] = thrust_at(inflow.rows[i], inflow.points, n, inflow.advance[i])
    return forces
