"""What there is to draw: the vehicle, its thrusters and its surroundings, read from the compiled model."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import RecordingError


@dataclass(frozen=True)
class ThrusterMounts:
    """Where the thrusters sit.

    Attributes:
        names: of the m actuators.
        positions: (m, 3) p_BT in body axes [m].
        axes: (m, 3) unit vectors of positive thrust in body axes.
        sizes: (m, 2) radius and half-length by which each site is drawn [m].
    """

    names: tuple[str, ...]
    positions: NDArray[np.float64]
    axes: NDArray[np.float64]
    sizes: NDArray[np.float64]


def vehicle_body(model: mujoco.MjModel) -> int:
    """Find the body that swims: the root of the tree with the first free joint.

    Raises:
        RecordingError: the model has no free joint.
    """
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if not free.size:
        raise RecordingError("the model has no free joint, so there is no vehicle to show")
    return int(model.jnt_bodyid[free[0]])


def vehicle_name(model: mujoco.MjModel) -> str:
    """Name of the body that swims."""
    return model.body(vehicle_body(model)).name or "vehicle"


def thruster_mounts(model: mujoco.MjModel) -> ThrusterMounts:
    """Read the site of every actuator that pushes the vehicle along its site's z axis."""
    body = vehicle_body(model)
    ids = [
        i
        for i in range(model.nu)
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_SITE
        and model.site_bodyid[model.actuator_trnid[i, 0]] == body
    ]
    sites = [int(model.actuator_trnid[i, 0]) for i in ids]
    rotations = np.array([rotation(model.site_quat[site]) for site in sites]).reshape(-1, 3, 3)
    return ThrusterMounts(
        names=tuple(model.actuator(i).name for i in ids),
        positions=model.site_pos[sites].copy(),
        axes=rotations[:, :, 2],
        sizes=model.site_size[sites, :2].copy(),
    )


def rotation(quaternion_wxyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn a quaternion (4,) wxyz into its rotation matrix (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion_wxyz)
    return matrix.reshape(3, 3)
