"""A vehicle's state read from MuJoCo's."""

from __future__ import annotations

import mujoco
import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import State
from cube_sim.vehicle.vehicle import Vehicle


def read_state(vehicle: Vehicle, data: mujoco.MjData) -> State:
    """Pose and velocity of a hull, as copies.

    MuJoCo's free joint has its linear velocity in world axes and its angular velocity in body axes. A `State` has both
    in body axes.

    Args:
        vehicle: a hull of the model.
        data: of that model, its attitudes up to date (mj_kinematics or mj_forward).
    """
    numbers = hull_state(
        data.qpos, data.qvel, data.xmat, data.xquat, vehicle.qpos_address, vehicle.dof_address, vehicle.body
    )
    return State(numbers[:3], numbers[3:7], numbers[7:16].reshape(3, 3), numbers[16:19], numbers[19:])


@compiled
def hull_state(qpos, qvel, xmat, xquat, at, dof, body):
    """The numbers of a `State` in the order of its attributes, (22,).

    Args:
        qpos: MuJoCo's, like the next three.
        qvel: of it.
        xmat: of it.
        xquat: of it.
        at: where the hull's pose begins.
        dof: where its velocity begins.
        body: its index.
    """
    numbers = np.empty(22)
    for i in range(3):
        numbers[i], numbers[19 + i] = qpos[at + i], qvel[dof + 3 + i]
        numbers[16 + i] = 0.0
        for j in range(3):
            numbers[7 + 3 * i + j] = xmat[body, 3 * i + j]
            numbers[16 + i] += qvel[dof + j] * xmat[body, 3 * j + i]
    for i in range(4):
        numbers[3 + i] = xquat[body, i]
    return numbers
