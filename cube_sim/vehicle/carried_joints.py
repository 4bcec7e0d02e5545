"""Joints of what a hull carries: of arms, sliding masses, flaps, whether anybody commands them or not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

_TURNS, _SLIDES = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_UNITS = {_TURNS: ("rad", "rad/s"), _SLIDES: ("m", "m/s")}


class JointPlaces(NamedTuple):
    """Where MuJoCo's data have their state, as the loop records it.

    Attributes:
        positions: (n,) indices into qpos.
        velocities: (k,) indices into qvel.
    """

    positions: NDArray[np.int_]
    velocities: NDArray[np.int_]


@dataclass(frozen=True)
class CarriedJoints:
    """The joints of a hull but for its own free one.

    A hinge and a slide have one number of position and one of velocity, called by the joint. A ball has four of
    position, its quaternion, called joint/w to joint/z, and three of velocity, in the axes of the body that it turns.

    Attributes:
        places: where their numbers are.
        positions: (n,) name and unit of each number of position.
        velocities: (k,) name and unit of each number of velocity.
    """

    places: JointPlaces
    positions: tuple[tuple[str, str], ...]
    velocities: tuple[tuple[str, str], ...]


def carried_joints(model: mujoco.MjModel, hull: int, prefix: str = "") -> CarriedJoints | None:
    """Those of one hull, in the order of the model; None for a hull that carries nothing that moves.

    Args:
        model: compiled.
        hull: its body.
        prefix: in front of every name of it in a model of several.
    """
    joints = joint_numbers(model, hull)
    if not joints:
        return None
    positions, velocities = list[tuple[str, str]](), list[tuple[str, str]]()
    qpos, qvel = list[int](), list[int]()
    for number, joint in enumerate(joints):
        name = model.joint(joint).name.removeprefix(prefix) or f"joint{number}"
        at, dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        units = _UNITS.get(int(model.jnt_type[joint]))
        if units is not None:
            positions.append((name, units[0]))
            velocities.append((name, units[1]))
            qpos.append(at)
            qvel.append(dof)
        else:
            positions += [(f"{name}/{axis}", "1") for axis in "wxyz"]
            velocities += [(f"{name}/{axis}", "rad/s") for axis in "xyz"]
            qpos += range(at, at + 4)
            qvel += range(dof, dof + 3)
    places = JointPlaces(np.array(qpos, dtype=np.int_), np.array(qvel, dtype=np.int_))
    return CarriedJoints(places, tuple(positions), tuple(velocities))


def joint_numbers(model: mujoco.MjModel, hull: int) -> list[int]:
    """Indices of the joints of what a hull carries, in the order of the model.

    Args:
        model: compiled.
        hull: its body, which the world carries.
    """
    free = model.jnt_type == mujoco.mjtJoint.mjJNT_FREE
    return np.flatnonzero((model.body_rootid[model.jnt_bodyid] == hull) & ~free).tolist()


def places_of(joints: CarriedJoints | None) -> JointPlaces:
    """Where their numbers are; none where there are no joints."""
    if joints is None:
        none = np.zeros(0, np.int_)
        return JointPlaces(none, none)
    return joints.places
