"""What an MJCF says of thrusters that holds for none of its actuators."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import mujoco

from cube_sim.vehicle.mjcf.numeric_names import THRUSTER_PARAMETERS
from cube_sim.vehicle.mjcf.thruster_elements import ThrusterElement, root_body

_CURVE = THRUSTER_PARAMETERS[0]
_SAID = "cube_sim:said"


def unused_thruster_words(
    spec: mujoco.MjSpec,
    numerics: Collection[str],
    hulls: Collection[str],
    thrusters: Sequence[ThrusterElement | None],
    servos: Collection[int],
) -> list[str]:
    """A sentence for each actuator that looks like a thruster and is none, and for each numeric that nothing reads.

    Args:
        spec: of the model.
        numerics: names of the file's; parameters given to `load_model` may well be of both a hull and its thrusters.
        hulls: names of the hulls.
        thrusters: one entry per actuator; None for one that is no thruster.
        servos: indices of the actuators that turn fins or pump ballast.
    """
    said = []
    for i, actuator in enumerate(spec.actuators):
        site = spec.site(actuator.target) if actuator.trntype == mujoco.mjtTrn.mjTRN_SITE else None
        body = root_body(site.parent) if site is not None else ""
        if thrusters[i] is None and i not in servos and body in hulls and f"{body}:{_CURVE}" in numerics:
            said.append(
                f"actuator '{actuator.name or i}' pushes '{body}' and is no thruster: it has no biastype=\"user\", so "
                f"that {body}:{_CURVE} does not hold for it"
            )
    for name in numerics:
        owner, _, parameter = name.rpartition(":")
        if parameter in THRUSTER_PARAMETERS and owner in hulls:
            its_own = [each.name for each in thrusters if each is not None and each.body == owner]
            if all(f"{thruster}:{parameter}" in numerics for thruster in its_own):
                why = "each has its own" if its_own else "it has none"
                said.append(f"{name} holds for no thruster of '{owner}': {why}")
    return said


def keep_words(spec: mujoco.MjSpec, words: Sequence[str]) -> None:
    """Let the compiled model say what was said of its file, for the log of whoever flies it."""
    if words:
        spec.add_text(name=_SAID, data="\n".join(words))


def kept_words(model: mujoco.MjModel) -> list[str]:
    """The sentences that `keep_words` put into a model."""
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXT, _SAID)
    if index < 0:
        return []
    start = int(model.text_adr[index])
    return model.text_data[start : start + int(model.text_size[index]) - 1].decode().split("\n")


def without_thrusters(model: mujoco.MjModel, hull: str) -> str:
    """What is said of a hull that has no thruster: that, and the first of what its file has that might be one."""
    seen = [words for words in kept_words(model) if words.startswith("actuator ") and f"'{hull}'" in words]
    return f"'{hull}' has no thruster" + (f": {seen[0]}" if seen else "")
