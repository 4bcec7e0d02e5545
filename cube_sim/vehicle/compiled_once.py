"""Models of one file that differ in numbers alone: compiled once, every other one is a copy that gets its numbers."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from cube_sim.errors import ModelError
from cube_sim.vehicle.changing import set_parameters
from cube_sim.vehicle.loading import load_unsaid
from cube_sim.vehicle.mjcf.elements import INERTIA

Parameters = Mapping[str, Sequence[float]]
Room = tuple[tuple[str, int], ...]

_ALONG_AXES = 3
"""Moments of inertia along the axes that the file gives a hull."""


def room(parameters: Parameters) -> Room:
    """What parameters take of a model, whatever they are: their names, and how many values each has."""
    return tuple(sorted((name, len(values)) for name, values in parameters.items()))


@dataclass(frozen=True)
class CompiledOnce:
    """A file as it was compiled with some parameters.

    Attributes:
        source: the MJCF file, or a spec built in memory.
        parameters: what it was compiled with.
        model: the compiled model, which nobody steps or changes.
    """

    source: str | Path | mujoco.MjSpec
    parameters: Parameters
    model: mujoco.MjModel

    @staticmethod
    def of(
        source: str | Path | mujoco.MjSpec,
        parameters: Parameters,
        pushes: int = 0,
        own_actuators: Mapping[str, range] | None = None,
    ) -> CompiledOnce:
        """Compile a file; arguments and errors are those of `load_unsaid`."""
        model = load_unsaid(source, parameters, pushes=pushes, own_actuators=own_actuators)
        return CompiledOnce(source, parameters, model)

    def has(self, parameters: Parameters) -> bool:
        """Whether it was compiled with just these."""
        return room(parameters) == room(self.parameters) and not self._changed(parameters)

    def with_parameters(self, parameters: Parameters) -> mujoco.MjModel | None:
        """A model of its own that has the numbers, to the bit, which `load_model` would give it.

        What only pictures are scaled by, `model.stat.extent` and `model.stat.meansize`, stays.

        Returns:
            None where the file has to be compiled: with other names or numbers of values, where more than numbers would
            change, and where they are refused, for the reason.
        """
        if room(parameters) != room(self.parameters):
            return None
        changed, model = self._changed(parameters), copy.copy(self.model)
        if not changed:
            return model
        if self._is_along_axes_of_the_file(changed, parameters):
            return None
        try:
            set_parameters(model, parameters)
        except ModelError:
            return None
        if self._cuts_off_another_part(model):
            return None
        return model

    def _changed(self, parameters: Parameters) -> list[str]:
        return [name for name, values in parameters.items() if tuple(values) != tuple(self.parameters[name])]

    def _spec(self) -> mujoco.MjSpec:
        source = self.source
        return source if isinstance(source, mujoco.MjSpec) else mujoco.MjSpec.from_file(str(source))

    def _is_along_axes_of_the_file(self, changed: Sequence[str], parameters: Parameters) -> bool:
        """Whether three moments of inertia take the place of six, whose axes the compiler chooses."""
        hulls = [
            name.rpartition(":")[0]
            for name in changed
            if name.rpartition(":")[2] == INERTIA and len(parameters[name]) == _ALONG_AXES
        ]
        return bool(hulls) and any(np.isfinite(self._spec().body(hull).fullinertia).all() for hull in hulls)

    def _cuts_off_another_part(self, model: mujoco.MjModel) -> bool:
        """Whether ranges in the file, which are held against the curves at load, would have to be so again."""
        moved = np.flatnonzero((model.actuator_ctrlrange != self.model.actuator_ctrlrange).any(axis=1))
        return bool(len(moved)) or self._is_limited_beside_its_curve()

    def _is_limited_beside_its_curve(self) -> bool:
        thrusters = self.model.actuator_biastype == mujoco.mjtBias.mjBIAS_USER
        limited = (self.model.actuator_forcelimited != 0) | (self.model.actuator_actlimited != 0)
        return bool((thrusters & limited).any())
