"""Bodies that move on a hull, and where each stands on what carries it, from the recorded positions of its joints."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.geometry import (
    body_shapes,
    rotation,
    shapes_reach,
    thruster_mounts,
    vehicle_body,
    vehicle_reach,
)
from cube_sim.spatial import product_components
from cube_sim.vehicle.carried_joints import joint_numbers

Rows = NDArray[np.float64]


@dataclass(frozen=True)
class _Joint:
    """One joint of a body: MuJoCo's type, jnt_pos and jnt_axis, its qpos0, and its columns among the positions."""

    kind: mujoco.mjtJoint
    anchor: Rows
    axis: Rows
    reference: Rows
    columns: slice


@dataclass(frozen=True)
class CarriedBody:
    """A body with joints on a hull, or on another such body; what is welded to a body belongs to it.

    Attributes:
        body: its index.
        name: of it, or ``body<i>``.
        parent: index of the body that carries it, the hull's or that of one before it.
        position: (3,) of its origin in the parent's axes before its joints move it [m].
        quaternion: (4,) wxyz, body to parent, before they do.
        joints: in the order in which they move it.
    """

    body: int
    name: str
    parent: int
    position: Rows
    quaternion: Rows
    joints: tuple[_Joint, ...]

    def pose(self, positions: Rows) -> tuple[Rows, Rows]:
        """Where it stands in the axes of its parent: (n, 3) [m] and (n, 4) wxyz.

        Each joint in turn, as MuJoCo does it (Computation, Kinematics): a slide moves along its axis, a hinge and a
        ball turn about their anchor.

        Args:
            positions: (n, w) of all joints on the hull, as the channel `joints` has them.
        """
        n = len(positions)
        p, q = np.tile(self.position, (n, 1)), np.tile(self.quaternion, (n, 1))
        for joint in self.joints:
            moved = positions[:, joint.columns]
            if joint.kind == mujoco.mjtJoint.mjJNT_SLIDE:
                p = p + _turned(q, joint.axis) * (moved - joint.reference)
                continue
            if joint.kind == mujoco.mjtJoint.mjJNT_HINGE:
                half = 0.5 * (moved - joint.reference)
                turn = np.hstack([np.cos(half), np.sin(half) * joint.axis])
            else:
                turn = moved / np.linalg.norm(moved, axis=1, keepdims=True)
            anchor = p + _turned(q, joint.anchor)
            q = _product(q, turn)
            p = anchor - _turned(q, joint.anchor)
        return p, q


def carried_bodies(model: mujoco.MjModel, vehicle: str | None = None) -> tuple[CarriedBody, ...]:
    """Those of a vehicle, each after what carries it.

    Args:
        model: compiled.
        vehicle: the body that swims; None for the first that can.
    """
    hull = vehicle_body(model, vehicle)
    columns, end = dict[int, slice](), 0
    for joint in joint_numbers(model, hull):
        width = 4 if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL else 1
        columns[joint] = slice(end, end + width)
        end += width
    return tuple(_body(model, body, columns) for body in dict.fromkeys(int(model.jnt_bodyid[j]) for j in columns))


def whole_reach(model: mujoco.MjModel, vehicle: str | None = None) -> float:
    """How far a vehicle as it is drawn reaches from its origin, with all that moves on it, however that stands [m].

    Thrusters are as large as they are drawn. A bound: as if every hinge could turn what it carries straight away from
    the hull, and every slide were at its end.
    """
    reaches = {each.body: shapes_reach(body_shapes(model, each.body)) for each in carried_bodies(model, vehicle)}
    mounts = thruster_mounts(model, vehicle)
    drawn = np.linalg.norm(mounts.positions, axis=1) + np.linalg.norm(mounts.sizes, axis=1)
    farthest = max(vehicle_reach(model, vehicle), float(drawn.max(initial=0.0)))
    for each in reversed(carried_bodies(model, vehicle)):
        reach = reaches[each.body] + _farthest_origin(model, each)
        if each.parent in reaches:
            reaches[each.parent] = max(reaches[each.parent], reach)
        else:
            farthest = max(farthest, reach)
    return farthest


def _farthest_origin(model: mujoco.MjModel, carried: CarriedBody) -> float:
    """How far the origin of a body may come from that of what carries it [m]."""
    farthest = float(np.linalg.norm(carried.position))
    first = int(model.body_jntadr[carried.body])
    for index, joint in enumerate(carried.joints, first):
        if joint.kind == mujoco.mjtJoint.mjJNT_SLIDE:
            farthest += float(np.abs(model.jnt_range[index] - joint.reference).max()) * bool(model.jnt_limited[index])
        else:
            farthest += 2.0 * float(np.linalg.norm(joint.anchor))
    return farthest


def positions_at_rest(model: mujoco.MjModel, vehicle: str | None = None) -> Rows:
    """(1, w) the positions of all joints on a hull in the reference pose."""
    joints = joint_numbers(model, vehicle_body(model, vehicle))
    return np.concatenate([np.zeros(0), *(_reference(model, joint) for joint in joints)])[None]


def _body(model: mujoco.MjModel, body: int, columns: dict[int, slice]) -> CarriedBody:
    parent = int(model.body_parentid[body])
    position, quaternion = model.body_pos[body].copy(), model.body_quat[body].copy()
    while parent != model.body_weldid[parent]:
        position = model.body_pos[parent] + rotation(model.body_quat[parent]) @ position
        quaternion = np.array(product_components(model.body_quat[parent], quaternion))
        parent = int(model.body_parentid[parent])
    first = int(model.body_jntadr[body])
    joints = tuple(
        _Joint(
            mujoco.mjtJoint(model.jnt_type[joint]),
            model.jnt_pos[joint].copy(),
            model.jnt_axis[joint].copy(),
            _reference(model, joint),
            columns[joint],
        )
        for joint in range(first, first + int(model.body_jntnum[body]))
    )
    return CarriedBody(body, model.body(body).name or f"body{body}", parent, position, quaternion, joints)


def _reference(model: mujoco.MjModel, joint: int) -> Rows:
    at = int(model.jnt_qposadr[joint])
    return model.qpos0[at : at + (4 if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL else 1)].copy()


def _product(p: Rows, q: Rows) -> Rows:
    return np.stack(product_components(p.T, q.T), axis=1)


def _turned(q: Rows, vector: Rows) -> Rows:
    """(n, 3) a vector (3,) turned by n unit quaternions."""
    scalar, axis = q[:, :1], q[:, 1:]
    across = 2.0 * np.cross(axis, vector)
    return vector + scalar * across + np.cross(axis, across)
