"""One row per channel and tick, written by one compiled law for every way a tick can be flown."""

from __future__ import annotations

from collections.abc import Iterator
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.native.compiled import compiled
from cube_sim.recording.channels import SUPPLY, Channel
from cube_sim.tuples import quaternion_from_matrix

Table = NDArray[np.float64]


class TickRows(NamedTuple):
    """Rows of the channels that get one at every tick: (n, 1 + width) each, column 0 the time [s].

    Attributes:
        supply: (4,) columns of `power` where power, energy, voltage and charge are; 0 for what is not recorded.
    """

    supply: NDArray[np.int64]

    pose: Table
    velocity: Table
    target: Table
    path_error: Table
    reference: Table
    wrench: Table
    allocation: Table
    thrusters: Table
    power: Table
    health: Table
    water: Table
    disturbance: Table
    fins: Table
    setpoints: Table
    joints: Table

    def named(self) -> Iterator[tuple[str, Table]]:
        """Channel and rows, for `SignalStore.extend`."""
        return ((name, table) for name, table in zip(self._fields[1:], self[1:], strict=True) if table.shape[1] > 1)

    def part(self, first: int, end: int) -> TickRows:
        """Those from one up to another."""
        return TickRows(self.supply, *(table[first:end] for table in self[1:]))


def rows_for(channels: tuple[Channel, ...], count: int) -> TickRows:
    """So many rows, to be written."""
    widths = {channel.name: 1 + channel.width for channel in channels}
    starts = {
        field.name: columns.start
        for channel in channels
        if channel.name == "power"
        for field, columns in zip(channel.fields, channel.columns, strict=True)
    }
    supply = np.array([starts.get(name, 0) for name in SUPPLY])
    return TickRows(supply, *(np.empty((count, widths.get(name, 1))) for name in TickRows._fields[1:]))


@compiled
def write_power(rows, k, t, power, energy, voltage, charge):
    """The row of the supply.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        power: (m,) [W].
        energy: drawn so far [J].
        voltage: [V].
        charge: share that is left.
    """
    row, at = rows.power[k], rows.supply
    if at[0]:
        for i in range(len(power)):
            row[at[0] + i] = power[i]
    if at[1]:
        row[at[1]] = energy
    if at[2]:
        row[at[2]] = voltage
    if at[3]:
        row[at[3]] = charge
    row[0] = t


@compiled
def write_motion(rows, k, t, state, seen, followed, quaternion, attitude_error, disturbance, current, water):
    """The rows of what the vehicle does and is to do.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        state: (22,) the true one, of `hull_state`.
        seen: record of `cube_sim.guidance.view_record.VIEW`.
        followed: record of `cube_sim.control.following.FOLLOWED`.
        quaternion: (4,) the desired attitude.
        attitude_error: of the true attitude [rad].
        disturbance: estimate (6,) [N, N m], body axes.
        current: estimate (3,) [m/s], world axes.
        water: (3,) its true velocity [m/s], world axes.
    """
    view, out = seen[0], followed[0]
    for table in (rows.pose, rows.velocity, rows.target, rows.path_error, rows.reference, rows.wrench, rows.water):
        table[k, 0] = t
    target, error = rows.target[k], rows.path_error[k]
    target[1], target[2] = view.arc_length, view.remaining
    orientation = quaternion_from_matrix(view.frame)
    for i in range(4):
        rows.pose[k, 4 + i], target[6 + i], rows.reference[k, 7 + i] = state[3 + i], orientation[i], quaternion[i]
    for i in range(3):
        rows.pose[k, 1 + i], target[3 + i] = state[i], view.row[i]
        rows.velocity[k, 1 + i], rows.velocity[k, 4 + i] = state[16 + i], state[19 + i]
        rows.reference[k, 1 + i], rows.reference[k, 4 + i] = out.velocity[i], out.rates[i]
        rows.water[k, 1 + i], rows.water[k, 4 + i] = water[i], current[i]
        error[1 + i] = 0.0
        for j in range(3):
            error[1 + i] += (state[j] - view.row[j]) * view.frame[j, i]
    error[4] = sqrt(error[2] * error[2] + error[3] * error[3])
    error[5] = attitude_error
    for i in range(6):
        rows.wrench[k, 1 + i], rows.wrench[k, 13 + i] = out.wrench[i], disturbance[i]


@compiled
def write_disturbance(rows, k, t, wrench):
    """The row of what pushes the vehicle.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        wrench: 6-tuple [N, N m], body axes, at the body origin.
    """
    rows.disturbance[k, 0] = t
    for i in range(6):
        rows.disturbance[k, 1 + i] = wrench[i]


@compiled
def write_fins(rows, k, t, wanted, deflections, made):
    """The row of the fins.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        wanted: (n,) deflections asked for [rad].
        deflections: (n,) [rad].
        made: (6,) what the fins are to make [N, N m].
    """
    n = len(wanted)
    rows.fins[k, 0] = t
    for i in range(n):
        rows.fins[k, 1 + i], rows.fins[k, 1 + n + i] = wanted[i], deflections[i]
    for i in range(6):
        rows.fins[k, 1 + 2 * n + i] = made[i]


@compiled
def write_setpoints(rows, k, t, setpoints, act):
    """The row of the scenario's set-points.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        setpoints: `cube_sim.mission.setpoints.SetpointParts`.
        act: MuJoCo's.
    """
    n = len(setpoints.actuators)
    rows.setpoints[k, 0] = t
    for i in range(n):
        actuator, activation = setpoints.actuators[i], setpoints.activations[i]
        rows.setpoints[k, 1 + i] = setpoints.wanted[i]
        rows.setpoints[k, 1 + n + i] = setpoints.lengths[actuator] if activation < 0 else act[activation]


@compiled
def write_joints(rows, k, t, joints, qpos, qvel):
    """The row of the joints of what the hull carries.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        joints: `cube_sim.vehicle.carried_joints.JointPlaces`.
        qpos: MuJoCo's.
        qvel: MuJoCo's.
    """
    n = len(joints.positions)
    rows.joints[k, 0] = t
    for i in range(n):
        rows.joints[k, 1 + i] = qpos[joints.positions[i]]
    for i in range(len(joints.velocities)):
        rows.joints[k, 1 + n + i] = qvel[joints.velocities[i]]


@compiled
def write_actuation(
    rows, k, t, wrench, force, commands, given, subset, residual, cost, status, efficiency, believed, authority
):
    """The rows of what the thrusters are told and do.

    Args:
        rows: `TickRows`.
        k: which of them.
        t: simulated time [s].
        wrench: (6,) allocated [N, N m].
        force: (m,) allocated [N].
        commands: (m,).
        given: (m,) force that is given [N].
        subset: (m,) sides.
        residual: [N].
        cost: [N^2].
        status: of the allocation.
        efficiency: (m,) true.
        believed: (m,).
        authority: its code.
    """
    m = len(force)
    rows.allocation[k, 0] = rows.thrusters[k, 0] = rows.health[k, 0] = t
    rows.allocation[k, 1], rows.allocation[k, 2], rows.allocation[k, 3] = residual, cost, status
    for i in range(6):
        rows.wrench[k, 7 + i] = wrench[i]
    for i in range(m):
        rows.allocation[k, 4 + i] = subset[i]
        rows.thrusters[k, 1 + i], rows.thrusters[k, 1 + m + i] = force[i], commands[i]
        rows.thrusters[k, 1 + 2 * m + i] = given[i]
        rows.health[k, 1 + i], rows.health[k, 1 + m + i] = efficiency[i], believed[i]
    rows.health[k, 1 + 2 * m] = authority
