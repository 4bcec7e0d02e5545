"""A vehicle's state read from MuJoCo's."""

from __future__ import annotations

import mujoco

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
    pose, velocity = vehicle.qpos_address, vehicle.dof_address
    rotation = data.xmat[vehicle.body].reshape(3, 3).copy()
    return State(
        position=data.qpos[pose : pose + 3].copy(),
        quaternion=data.xquat[vehicle.body].copy(),
        rotation=rotation,
        velocity=data.qvel[velocity : velocity + 3] @ rotation,
        rates=data.qvel[velocity + 3 : velocity + 6].copy(),
    )
