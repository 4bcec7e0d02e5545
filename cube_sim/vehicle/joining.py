"""Several vehicles in one model, so that they share their water and can touch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import ModelError
from cube_sim.vehicle.loading import load_unsaid
from cube_sim.vehicle.mjcf.numeric_names import force_owner
from cube_sim.vehicle.plugin.user_force_kinds import kind_of
from cube_sim.vehicle.plugin.user_forces import resolve
from cube_sim.vehicle.thrusters import Thrusters
from cube_sim.vehicle.vehicle import Vehicle

_SET_FOR_ALL = ("timestep", "integrator", "wind")
"""Options that whoever flies the model sets himself."""


@dataclass(frozen=True)
class ModelPart:
    """One MJCF among those that are joined.

    Attributes:
        file: of the MJCF.
        prefix: of all its names in the joined model; "" where it is alone.
        parameters: values in place of its own, as for `load_model`.
        again: whether what stands still around its vehicles is there already, of the same file.
    """

    file: str
    prefix: str
    parameters: Mapping[str, ArrayLike] = field(default_factory=dict)
    again: bool = False


def joined_model(parts: Sequence[ModelPart], pushes: int = 0) -> mujoco.MjModel:
    """Compile MJCF files into one model with water.

    Args:
        parts: one or more; of a single one the model is that of `load_model`.
        pushes: for how many forces from outside there is to be room, as for `load_model`.

    Raises:
        ModelError: they cannot be joined: their waters or options differ; names the element.
    """
    if len(parts) == 1 and not parts[0].prefix:
        return load_unsaid(parts[0].file, parts[0].parameters, pushes=pushes)
    whole = mujoco.MjSpec()
    whole.modelname = "fleet"
    whole.compiler.conflict = mujoco.mjtConflict.mjCONFLICT_MERGE
    parameters: dict[str, ArrayLike] = {}
    for index, part in enumerate(parts):
        spec = mujoco.MjSpec.from_file(part.file)
        if index == 0:
            _take_options(whole, spec)
        else:
            _require_same_options(whole, spec, part)
            for name in _SET_FOR_ALL:  # of a difference MuJoCo would tell at attaching
                setattr(spec.option, name, getattr(whole.option, name))
        if part.again:
            _leave_surroundings(spec)
        for key in list(spec.keys):  # of a state of this model alone
            spec.delete(key)
        if len(whole.actuators) > 0:
            _require_blind_forces(spec, part)
        whole.attach(spec, prefix=part.prefix, frame=whole.worldbody.add_frame())
        parameters |= {f"{part.prefix}{name}": value for name, value in part.parameters.items()}
    return load_unsaid(whole, parameters, pushes=pushes)


def vehicle_in(model: mujoco.MjModel, alone: Vehicle, prefix: str) -> Vehicle:
    """A vehicle where a joined model has it, with the numbers and the short names it has alone.

    Args:
        model: the joined one.
        alone: the vehicle in the model of its file.
        prefix: of its names there.
    """
    there = Vehicle.from_model(model, f"{prefix}{alone.name}")
    names = tuple(name.removeprefix(prefix) for name in there.thrusters.names)
    thrusters = _with_indices(alone.thrusters, there.thrusters, prefix)
    fins = None if alone.fins is None or there.fins is None else replace(there.fins, names=alone.fins.names)
    ballast = there.ballast
    if alone.ballast is not None and ballast is not None:
        ballast = replace(ballast, names=alone.ballast.names)
    if names != alone.thrusters.names:
        raise ModelError(there.name, f"has the thrusters {', '.join(names)} among others, and others alone")
    return replace(
        alone,
        name=there.name,
        body=there.body,
        qpos_address=there.qpos_address,
        dof_address=there.dof_address,
        thrusters=thrusters,
        fins=fins,
        ballast=ballast,
    )


def _with_indices(alone: Thrusters, there: Thrusters, prefix: str) -> Thrusters:
    return replace(alone, actuators=there.actuators, activations=there.activations, prefix=prefix)


def _take_options(whole: mujoco.MjSpec, spec: mujoco.MjSpec) -> None:
    for name in _options(spec):
        value = getattr(spec.option, name)
        setattr(whole.option, name, value.copy() if isinstance(value, np.ndarray) else value)
    whole.compiler.autolimits = spec.compiler.autolimits


def _require_same_options(whole: mujoco.MjSpec, spec: mujoco.MjSpec, part: ModelPart) -> None:
    for name in _options(spec):
        here, there = getattr(whole.option, name), getattr(spec.option, name)
        if name not in _SET_FOR_ALL and not np.array_equal(here, there):
            said = f"{name} is {_shown(there)}, that of the vehicles before it {_shown(here)}: there is one world"
            raise ModelError("option", said, part.file)


def _require_blind_forces(spec: mujoco.MjSpec, part: ModelPart) -> None:
    """Refuse a hull's own force that reads commands: it counts actuators of its file, which come behind others here."""
    bodies = [body.name for body in spec.bodies]
    for text in spec.texts:
        if force_owner(text.name, text.data, bodies) is None:
            continue
        if kind_of(resolve(text.data, text.name), text.name).sees:
            said = "reads commands and activations by their number, which other vehicles shift: put its vehicle first"
            raise ModelError(f"{part.prefix}{text.name}", said, part.file)


def _options(spec: mujoco.MjSpec) -> list[str]:
    return [name for name in dir(spec.option) if not name.startswith("_")]


def _shown(value: ArrayLike) -> str:
    return " ".join(f"{each:g}" for each in np.ravel(np.asarray(value, dtype=float)))


def _leave_surroundings(spec: mujoco.MjSpec) -> None:
    """Take out what is there already: geoms, lights and cameras of the world."""
    world = spec.worldbody
    for element in (*world.geoms, *world.lights, *world.cameras):
        spec.delete(element)
