"""Servos and springs of joints that are too stiff for a model's time step."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

from cube_sim.vehicle.other_actuators import driven_joint

NEAR = 0.5
"""Share of the longest stable step that is worth a word (a choice)."""
_TAKEN = 0.4  # of it, in the words: a step of it is worth none
_ROUNDING = 1e-9
_MOVING = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_IMPLICIT = int(mujoco.mjtIntegrator.mjINT_IMPLICIT), int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST)


class Spring(NamedTuple):
    """What holds a joint, as one equation: m q'' + d q' + k q = 0, q about where it holds it.

    Attributes:
        inertia: m, of all that moves with it, with the added mass [kg m^2 or kg].
        stiffness: k [N m/rad or N/m].
        joint_damping: part of d that the joint has [N m s/rad or N s/m].
        servo_damping: part of d that actuators have.
    """

    inertia: float
    stiffness: float
    joint_damping: float
    servo_damping: float


def stiff_servo_words(model: mujoco.MjModel, root: int) -> list[str]:
    """A sentence on the stiffest joint of a vehicle, where MuJoCo's step is near or beyond what carries it.

    Each joint by itself, the others free, at the reference pose: several are at most as many times as stiff together.

    Args:
        model: made by `load_model`.
        root: body of the hull.
    """
    found = []
    for joint in range(model.njnt):
        if model.body_rootid[model.jnt_bodyid[joint]] != root:
            continue
        spring, servos = _spring(model, joint)
        if min(spring) < 0.0 or not any(spring[1:]):  # one that pushes away grows by itself, at any step
            continue
        if (step := longest_stable_step(model, spring)) is not None:
            found.append((step, joint, servos))
    if not found:
        return []
    longest, joint, servos = min(found)
    named = " and ".join(f"'{model.actuator(i).name or i}' ({_prm(model, i)})" for i in servos)
    what = f"the servo {named} of joint" if servos else "the spring and damper of joint"
    return [
        f"{what} '{model.joint(joint).name}' is stiff for the time step of {model.opt.timestep:g} s: beyond "
        f"{longest:.2g} s the motion explodes; take a step of {_TAKEN * longest:.2g} s (physics.step_s of a scenario), "
        f"or a softer {'kp and kv' if servos else 'stiffness and damping'}"
    ]


def longest_stable_step(model: mujoco.MjModel, spring: Spring) -> float | None:
    """The longest time step that carries a joint [s]; None where it is longer than the model's over `NEAR`."""
    low, high = 0.0, model.opt.timestep / NEAR
    if _is_stable(model, spring, high):
        return None
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _is_stable(model, spring, middle) else (low, middle)
    return low


def _is_stable(model: mujoco.MjModel, spring: Spring, step: float) -> bool:
    """Whether one step of MuJoCo's integrators, a matrix on [q, q'], lets nothing grow.

    RK4 is 1 + x + x^2/2 + x^3/6 + x^4/24 of the equation's matrix. The others take q' first, then q by the new one,
    with the damping of joints (Euler) or all damping (implicit) at the end of the step.
    """
    m, k, of_joint, of_servo = spring
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        x = step * np.array([[0.0, 1.0], [-k / m, -(of_joint + of_servo) / m]])
        matrix = np.eye(2) + x @ (np.eye(2) + x / 2.0 @ (np.eye(2) + x / 3.0 @ (np.eye(2) + x / 4.0)))
    else:
        at_the_end = of_joint + of_servo if model.opt.integrator in _IMPLICIT else of_joint
        if model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_EULERDAMP and model.opt.integrator not in _IMPLICIT:
            at_the_end = 0.0
        heavier = m + step * at_the_end
        velocity = np.array([-step * k / heavier, 1.0 - step * (of_joint + of_servo) / heavier])
        matrix = np.array([[1.0 + step * velocity[0], step * velocity[1]], velocity])
    return bool(np.abs(np.linalg.eigvals(matrix)).max() <= 1.0 + _ROUNDING)


def _spring(model: mujoco.MjModel, joint: int) -> tuple[Spring, list[int]]:
    """What holds a hinge or slide, and its servos; what holds nothing for another joint."""
    dof = int(model.jnt_dofadr[joint])
    if model.jnt_type[joint] not in _MOVING:
        return Spring(1.0, 0.0, 0.0, 0.0), []
    stiffness, damping, servos = float(np.ravel(model.jnt_stiffness[joint])[0]), 0.0, []
    for i in range(model.nu):
        if driven_joint(model, i) != joint or model.actuator_biastype[i] != mujoco.mjtBias.mjBIAS_AFFINE:
            continue
        squared = float(model.actuator_gear[i, 0]) ** 2
        stiffness -= squared * float(model.actuator_biasprm[i, 1])
        damping -= squared * float(model.actuator_biasprm[i, 2])
        servos.append(i)
    inertia = 1.0 / float(model.dof_invweight0[dof])
    return Spring(inertia, stiffness, float(np.ravel(model.dof_damping[dof])[0]), damping), servos


def _prm(model: mujoco.MjModel, actuator: int) -> str:
    stiffness, damping = (-float(each) for each in model.actuator_biasprm[actuator, 1:3])
    return f"kp {stiffness:g}, kv {damping:g}"
