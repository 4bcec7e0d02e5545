"""Actuators of a model that are neither thrusters nor servos of fins: joints of arms, moving masses, ballast."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco

from cube_sim.vehicle.plugin import layout, packing
from cube_sim.vehicle.vehicle import Vehicle

_JOINTS = int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT)
_LAGS = int(mujoco.mjtDyn.mjDYN_FILTER), int(mujoco.mjtDyn.mjDYN_FILTEREXACT), int(mujoco.mjtDyn.mjDYN_USER)
_MOVING = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)


@dataclass(frozen=True)
class OtherActuator:
    """One of them.

    Attributes:
        name: that it has in the model of its own file.
        index: into ctrl.
        activation: where in act it stands at what it has reached; -1 for one whose length MuJoCo tells (of a joint).
        wanted_unit: of its command.
        reached_unit: of what it has reached.
    """

    name: str
    index: int
    activation: int
    wanted_unit: str
    reached_unit: str


def other_actuators(model: mujoco.MjModel, vehicle: Vehicle) -> dict[str, OtherActuator]:
    """Those of a vehicle and of nobody, by the name each has in the model of its own file.

    Args:
        model: made by `load_model`.
        vehicle: a hull of it.
    """
    prefix, packed, found = vehicle.thrusters.prefix, packing.packed_parameters(model), dict[str, OtherActuator]()
    table = int(packed[layout.THRUSTERS])
    for i in range(model.nu):
        name, kind = model.actuator(i).name, int(packed[table + i])
        taken = kind >= 0 or kind in (layout.FIN_SERVO, layout.FORCE_STATE)
        if taken or not name.startswith(prefix) or _root(model, i) not in (vehicle.body, 0):
            continue
        wanted, reached = _units(model, i)
        activation = -1
        if kind == layout.BALLAST_STATE:
            wanted = reached = "m^3"
            activation = int(model.actuator_actadr[i])
        found[name.removeprefix(prefix)] = OtherActuator(name.removeprefix(prefix), i, activation, wanted, reached)
    found.pop("", None)
    return found


def allowed_commands(model: mujoco.MjModel, actuator: int) -> tuple[float, float]:
    """Least and largest command that an actuator follows, by its own limits and those of its joint."""
    low, high = -float("inf"), float("inf")
    if model.actuator_ctrllimited[actuator]:
        low, high = model.actuator_ctrlrange[actuator].tolist()
    joint, gear = driven_joint(model, actuator), float(model.actuator_gear[actuator, 0])
    if joint >= 0 and is_position_servo(model, actuator) and model.jnt_limited[joint]:
        ends = sorted(gear * end for end in model.jnt_range[joint].tolist())
        low, high = max(low, ends[0]), min(high, ends[1])
    return low, high


def is_position_servo(model: mujoco.MjModel, actuator: int) -> bool:
    """Whether an actuator pushes by how far it is from its command: a spring about it."""
    gain, stiffness = model.actuator_gainprm[actuator, 0], model.actuator_biasprm[actuator, 1]
    affine = model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_AFFINE
    return bool(affine and gain != 0.0 and stiffness == -gain)


def stand_at(model: mujoco.MjModel, data: mujoco.MjData, actuator: int, command: float) -> None:
    """Let an actuator stand where a command brings it: its activation, and the joint that it is a position servo of.

    Args:
        model: made by `load_model`.
        data: changed here.
        actuator: its index.
        command: in its own unit.
    """
    data.ctrl[actuator] = command
    first, count = int(model.actuator_actadr[actuator]), int(model.actuator_actnum[actuator])
    if first >= 0 and model.actuator_dyntype[actuator] in _LAGS:
        data.act[first : first + count] = command
    joint, gear = driven_joint(model, actuator), float(model.actuator_gear[actuator, 0])
    if joint >= 0 and gear != 0.0 and is_position_servo(model, actuator):
        data.qpos[model.jnt_qposadr[joint]] = command / gear


def driven_joint(model: mujoco.MjModel, actuator: int) -> int:
    """The hinge or slide that an actuator drives; -1 for none."""
    if model.actuator_trntype[actuator] not in _JOINTS:
        return -1
    joint = int(model.actuator_trnid[actuator, 0])
    return joint if model.jnt_type[joint] in _MOVING else -1


def _root(model: mujoco.MjModel, actuator: int) -> int:
    """The body of the world that carries what an actuator drives; the world where that is no joint and no site."""
    target = int(model.actuator_trnid[actuator, 0])
    if model.actuator_trntype[actuator] in _JOINTS:
        return int(model.body_rootid[model.jnt_bodyid[target]])
    if model.actuator_trntype[actuator] == mujoco.mjtTrn.mjTRN_SITE:
        return int(model.body_rootid[model.site_bodyid[target]])
    return 0


def _units(model: mujoco.MjModel, actuator: int) -> tuple[str, str]:
    """Of the command, and of what is reached; "1" where nobody knows."""
    joint = driven_joint(model, actuator)
    if joint < 0:
        return "1", "1"
    turns = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
    reached = "rad" if turns else "m"
    if is_position_servo(model, actuator):
        return reached, reached
    plain = model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
    motor = plain and model.actuator_gainprm[actuator, 0] == 1.0 and model.actuator_gear[actuator, 0] == 1.0
    return ("N m" if turns else "N") if motor else "1", reached
