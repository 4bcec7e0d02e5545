"""The state of a whole flight as bytes: physics, and all that controller, estimators and allocation remember."""

from __future__ import annotations

import io
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


@dataclass(frozen=True)
class Snapshot:
    """A moment of a flight. It can be pickled, and taken up by any flight of the same scenario, to the bit.

    Attributes:
        digest: of the scenario it belongs to.
        content: what changes in a flight.
    """

    digest: str
    content: bytes


class _Pickler(pickle.Pickler):
    """Leaves out what never changes in a flight: those things go by their names."""

    def __init__(self, file: io.BytesIO, fixed: Mapping[str, Any]) -> None:
        super().__init__(file, protocol=pickle.HIGHEST_PROTOCOL)
        self._names = {id(thing): name for name, thing in fixed.items()}

    def persistent_id(self, obj: Any) -> str | None:
        return self._names.get(id(obj))

    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, mujoco.MjData):
            return data_at, (obj.model, integration_state(obj.model, obj))
        return NotImplemented


class _Unpickler(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, fixed: Mapping[str, Any]) -> None:
        super().__init__(file)
        self._fixed = fixed

    def persistent_load(self, pid: str) -> Any:
        return self._fixed[pid]


def packed(changing: Any, fixed: Mapping[str, Any]) -> bytes:
    """What changes in a flight as bytes.

    Args:
        changing: any objects.
        fixed: name -> thing that they refer to and that never changes.
    """
    file = io.BytesIO()
    _Pickler(file, fixed).dump(changing)
    return file.getvalue()


def unpacked(content: bytes, fixed: Mapping[str, Any]) -> Any:
    """The objects again; they refer to the fixed things given here."""
    return _Unpickler(io.BytesIO(content), fixed).load()


def integration_state(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """All that MuJoCo needs to go on to the bit."""
    state = np.empty(mujoco.mj_stateSize(model, _STATE))
    mujoco.mj_getState(model, data, state, _STATE)
    return state


def set_integration_state(model: mujoco.MjModel, data: mujoco.MjData, state: NDArray[np.float64]) -> None:
    """Go on from there."""
    mujoco.mj_setState(model, data, state, _STATE)


def data_at(model: mujoco.MjModel, state: NDArray[np.float64]) -> mujoco.MjData:
    """New data of a model in a state."""
    data = mujoco.MjData(model)
    set_integration_state(model, data, state)
    return data
