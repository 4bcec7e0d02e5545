"""What there is to draw: the vehicle, its thrusters and its surroundings, read from the compiled model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import RecordingError
from cube_sim.vehicle.mjcf.thruster_elements import thruster_actuators


@dataclass(frozen=True)
class ThrusterMounts:
    """Where the thrusters sit, on the hull or on what it carries; what moves on it is in its reference pose.

    Attributes:
        names: of the m thrusters.
        positions: (m, 3) p_BT in body axes [m].
        rotations: (m, 3, 3) site axes to body axes.
        axes: (m, 3) unit vectors of positive force in body axes: the site's z axis, or against it by a negative gear.
        sizes: (m, 2) radius and half-length by which each site is drawn [m].
        moving: names of those on what moves on the hull, where no record says how it stands.
    """

    names: tuple[str, ...]
    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]
    axes: NDArray[np.float64]
    sizes: NDArray[np.float64]
    moving: tuple[str, ...]


def vehicle_body(model: mujoco.MjModel, name: str | None = None) -> int:
    """Find the body that swims: the one of this name, or the root of the tree with the first free joint.

    Raises:
        RecordingError: the model has no such body, or no free joint.
    """
    if name is not None:
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        if body < 0:
            raise RecordingError(f"the model has no body '{name}', so there is no vehicle to show")
        return body
    free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if not free.size:
        raise RecordingError("the model has no free joint, so there is no vehicle to show")
    return int(model.jnt_bodyid[free[0]])


def vehicle_name(model: mujoco.MjModel) -> str:
    """Name of the body that swims, when nobody says which one it is."""
    return model.body(vehicle_body(model)).name or "vehicle"


def thruster_mounts(model: mujoco.MjModel, vehicle: str | None = None) -> ThrusterMounts:
    """Read the site of every thruster of the vehicle, in the order in which the record has their forces."""
    hull = vehicle_body(model, vehicle)
    ids = thruster_actuators(model, hull)
    sites = [int(model.actuator_trnid[i, 0]) for i in ids]
    poses = [_site_pose(model, site, hull) for site in sites]
    rotations = np.array([frame for _, frame in poses]).reshape(-1, 3, 3)
    return ThrusterMounts(
        names=tuple(model.actuator(i).name for i in ids),
        positions=np.array([position for position, _ in poses]).reshape(-1, 3),
        rotations=rotations,
        axes=np.sign(model.actuator_gear[ids, 2])[:, None] * rotations[:, :, 2],
        sizes=model.site_size[sites, :2].copy(),
        moving=tuple(
            model.actuator(i).name
            for i, site in zip(ids, sites, strict=True)
            if model.body_weldid[model.site_bodyid[site]] != hull
        ),
    )


def _site_pose(model: mujoco.MjModel, site: int, hull: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """p_HS (3,) [m] and R_HS (3, 3) of a site on a hull: from body to body, exact where it is on the hull itself."""
    position, frame = model.site_pos[site].copy(), rotation(model.site_quat[site])
    body = int(model.site_bodyid[site])
    while body != hull:
        R = rotation(model.body_quat[body])
        position, frame = model.body_pos[body] + R @ position, R @ frame
        body = int(model.body_parentid[body])
    return position, frame


def vehicle_reach(model: mujoco.MjModel, vehicle: str | None = None) -> float:
    """How far the vehicle reaches from its origin, its shapes and its thrusters, but for what moves on it [m]."""
    far = np.linalg.norm(thruster_mounts(model, vehicle).positions, axis=1)
    return max(shapes_reach(vehicle_shapes(model, vehicle)), float(far.max(initial=0.0)))


def shapes_reach(shapes: Sequence[Shape]) -> float:
    """How far shapes reach from the origin of the frame they are given in [m]; 0 for none."""
    signs, farthest = np.array(list(product((-1.0, 1.0), repeat=3))), 0.0
    for shape in shapes:
        corners = shape.position + (shape.box[0] + signs * shape.box[1]) @ shape.rotation.T
        farthest = max(farthest, float(np.linalg.norm(corners, axis=1).max()))
    return farthest


def rotation(quaternion_wxyz: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn a quaternion (4,) wxyz into its rotation matrix (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion_wxyz)
    return matrix.reshape(3, 3)


@dataclass(frozen=True)
class Shape:
    """A geom in the frame it moves with.

    Attributes:
        name: of the geom, or ``geom<i>``.
        kind: its type.
        size: (3,) as MuJoCo has it, half lengths and radii [m].
        position: (3,) centre [m].
        rotation: (3, 3) geom axes to frame axes.
        rgba: (4,) 0 to 1.
        mesh: index of its mesh, or -1.
        box: (2, 3) centre and half lengths of the box around it, geom axes [m].
    """

    name: str
    kind: mujoco.mjtGeom
    size: NDArray[np.float64]
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    rgba: NDArray[np.float64]
    mesh: int
    box: NDArray[np.float64]


def vehicle_shapes(model: mujoco.MjModel, vehicle: str | None = None) -> list[Shape]:
    """List the geoms that move with the vehicle, in body axes."""
    return body_shapes(model, vehicle_body(model, vehicle))


def body_shapes(model: mujoco.MjModel, body: int) -> list[Shape]:
    """List the geoms of a body that moves and of what is welded to it, in its axes."""
    return _shapes(model, body, [i for i in range(model.ngeom) if _welded_to(model, i) == body])


def world_shapes(model: mujoco.MjModel) -> list[Shape]:
    """List the geoms that never move, in world axes."""
    return _shapes(model, 0, [i for i in range(model.ngeom) if _welded_to(model, i) == 0])


def _welded_to(model: mujoco.MjModel, geom: int) -> int:
    return int(model.body_weldid[model.geom_bodyid[geom]])


def _shapes(model: mujoco.MjModel, frame: int, geoms: list[int]) -> list[Shape]:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    R_WF, p_WF = data.xmat[frame].reshape(3, 3), data.xpos[frame]
    return [
        Shape(
            name=model.geom(i).name or f"geom{i}",
            kind=mujoco.mjtGeom(model.geom_type[i]),
            size=model.geom_size[i].copy(),
            position=R_WF.T @ (data.geom_xpos[i] - p_WF),
            rotation=R_WF.T @ data.geom_xmat[i].reshape(3, 3),
            rgba=_colour(model, i),
            mesh=int(model.geom_dataid[i]) if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_MESH else -1,
            box=model.geom_aabb[i].reshape(2, 3).copy(),
        )
        for i in geoms
    ]


def _colour(model: mujoco.MjModel, geom: int) -> NDArray[np.float64]:
    material = int(model.geom_matid[geom])
    return (model.mat_rgba[material] if material >= 0 else model.geom_rgba[geom]).astype(float)
