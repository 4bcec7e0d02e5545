"""What changes in a flight as bytes, and as objects again: MuJoCo's data and functions made in functions among it."""

from __future__ import annotations

import io
import marshal
import pickle
import sys
from collections.abc import Mapping
from types import CellType, FunctionType
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


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
        if isinstance(obj, FunctionType) and "<" in obj.__qualname__ and obj.__module__ in sys.modules:
            cells = obj.__closure__ or ()
            made = (marshal.dumps(obj.__code__), obj.__module__, cells)
            # What it holds may refer to it, so that comes when it is there.
            named = {name: getattr(obj, name) for name in ("__qualname__", "__defaults__", "__kwdefaults__")}
            return _function, made, (named, vars(obj), [_held(cell) for cell in cells]), None, None, _fill
        if isinstance(obj, CellType):
            return _cell, ()
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


def _function(code: bytes, module: str, cells: tuple[CellType, ...]) -> FunctionType:
    return FunctionType(marshal.loads(code), vars(sys.modules[module]), closure=cells)


def _cell() -> CellType:
    return CellType()


def _held(cell: CellType) -> tuple[Any, ...]:
    """What a cell holds, () for nothing yet."""
    try:
        return (cell.cell_contents,)
    except ValueError:
        return ()


def _fill(function: FunctionType, state: tuple[dict[str, Any], dict[str, Any], list[tuple[Any, ...]]]) -> None:
    named, attributes, held = state
    for name, value in named.items():
        setattr(function, name, value)
    vars(function).update(attributes)
    for cell, contents in zip(function.__closure__ or (), held, strict=True):
        if contents:
            cell.cell_contents = contents[0]
