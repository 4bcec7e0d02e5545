"""Position servos of joints that push the wrong way, or whose commands are most likely in another unit."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import mujoco

from cube_sim.vehicle.other_actuators import driven_joint, is_position_servo

FARTHEST = 10.0
"""Way of a command beyond the ends of a joint, in lengths of its range, from which it is named (a choice).

Degrees in place of radians go 28 beyond, millimetres in place of metres 500.
"""


def unlikely_servos(model: mujoco.MjModel, hulls: Collection[str]) -> Iterator[str]:
    """Sentences on the stiffness and the commands of position servos.

    Args:
        model: made by `load_model`.
        hulls: whose.
    """
    roots = {model.body(hull).id for hull in hulls}
    for i in range(model.nu):
        joint = driven_joint(model, i)
        if joint < 0 or not is_position_servo(model, i) or int(model.body_rootid[model.jnt_bodyid[joint]]) not in roots:
            continue
        servo, moved = model.actuator(i).name or str(i), model.joint(joint).name or str(joint)
        if (kp := float(model.actuator_gainprm[i, 0])) < 0.0:
            yield (
                f"servo '{servo}' has a kp of {kp:g}: it pushes joint '{moved}' away from where it is told; a positive "
                "kp pulls it there"
            )
        if not (model.actuator_ctrllimited[i] and model.jnt_limited[joint]):
            continue
        low, high = model.actuator_ctrlrange[i].tolist()
        start, end = sorted(float(model.actuator_gear[i, 0]) * each for each in model.jnt_range[joint].tolist())
        if max(start - low, high - end) > FARTHEST * (end - start) > 0.0:
            unit = "rad" if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE else "m"
            yield (
                f"servo '{servo}' takes commands from {low:g} to {high:g} {unit}, and its joint '{moved}' goes from "
                f"{start:g} to {end:g}; is its ctrlrange in [{unit}]?"
            )
