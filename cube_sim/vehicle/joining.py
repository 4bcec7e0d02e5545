"""Several vehicles in one model, so that they share their water and can touch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from cube_sim.errors import ModelError
from cube_sim.vehicle.compiled_once import CompiledOnce, Parameters
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
    parameters: Parameters = field(default_factory=dict)
    again: bool = False


class Joined(NamedTuple):
    """MJCF files as one.

    Attributes:
        source: the spec of all; of a single file without a prefix, that file.
        own_actuators: hull -> those that its own force counts, which are its file's.
    """

    source: str | mujoco.MjSpec
    own_actuators: Mapping[str, range]


def compiled_together(parts: Sequence[ModelPart], pushes: int = 0) -> CompiledOnce:
    """Compile MJCF files into one model with water.

    Args:
        parts: one or more; of a single one the model is that of `load_model`.
        pushes: for how many forces from outside there is to be room, as for `load_model`.

    Raises:
        ModelError: they cannot be joined: their waters or options differ; names the element.
    """
    source, own_actuators = _joined(parts)
    return CompiledOnce.of(source, joined_parameters(parts), pushes, own_actuators)


def joined_parameters(parts: Sequence[ModelPart]) -> Parameters:
    """The parameters of files, as their joined model has them."""
    return {f"{part.prefix}{name}": value for part in parts for name, value in part.parameters.items()}


def _joined(parts: Sequence[ModelPart]) -> Joined:
    if len(parts) == 1 and not parts[0].prefix:
        return Joined(parts[0].file, {})
    whole = mujoco.MjSpec()
    whole.modelname = "fleet"
    whole.compiler.conflict = mujoco.mjtConflict.mjCONFLICT_MERGE
    own_actuators: dict[str, range] = {}
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
        bodies, before = [body.name for body in spec.bodies], len(whole.actuators)
        whole.attach(spec, prefix=part.prefix, frame=whole.worldbody.add_frame())
        own_actuators |= {f"{part.prefix}{name}": range(before, len(whole.actuators)) for name in bodies if name}
    return Joined(whole, own_actuators)


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


def _options(spec: mujoco.MjSpec) -> list[str]:
    return [name for name in dir(spec.option) if not name.startswith("_")]


def _shown(value: ArrayLike) -> str:
    return " ".join(f"{each:g}" for each in np.ravel(np.asarray(value, dtype=float)))


def _leave_surroundings(spec: mujoco.MjSpec) -> None:
    """Take out what is there already: geoms, lights and cameras of the world."""
    world = spec.worldbody
    for element in (*world.geoms, *world.lights, *world.cameras):
        spec.delete(element)
