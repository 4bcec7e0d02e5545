"""A function of the user's own that is to be compiled, and what it reads and remembers: records, packed from values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from inspect import isfunction
from typing import Any

import numpy as np

from cube_sim.native.asking import WORD
from cube_sim.native.checked import checked
from cube_sim.native.function import CompiledFunction
from cube_sim.spatial import Record

_WORD = WORD.itemsize
_NOTHING = {"nothing": 0.0}


@dataclass(frozen=True)
class CompiledPart:
    """What a factory makes that wants to fly without Python; `compiled` makes it.

    Attributes:
        function: of an aim, the parameters and the memory.
        parameters: (1,) structured.
        memory: (1,) structured, moved on by the function.
    """

    function: CompiledFunction
    parameters: Record
    memory: Record


def compiled(
    function: Callable[..., Any],
    parameters: Mapping[str, Any] | None = None,
    memory: Mapping[str, Any] | None = None,
) -> CompiledPart:
    """A function for the loop of a flight, compiled by numba and called at every tick without Python.

    Args:
        function: of an aim, the parameters and the memory, whose fields it has as attributes: ``step(aim, p, m)``. It
            has to be one that numba compiles (`numba.njit`, nopython).
        parameters: name -> number or array, that it reads.
        memory: likewise, with which it begins: it writes ``m.total[:] = ...`` or ``m.count += 1``. A whole number of
            Python's or a list of them is the start of what need not stay one, and becomes float64; what numpy has as
            int64 stays it.

    Raises:
        TypeError: it is no function, a name is none, or a value is neither a number nor an array of numbers.
    """
    plain = getattr(function, "py_func", function)
    if not isfunction(plain):
        raise TypeError(f"compiled takes a function, not a {type(function).__name__}")
    for values in (parameters or {}, memory or {}):
        _require_names(values)
    return CompiledPart(_compiled(plain), record_of_values(parameters or {}), record_of_values(started(memory or {})))


def started(memory: Mapping[str, Any]) -> dict[str, Any]:
    """The same values, whole numbers of Python's as floats."""
    return {name: _floats(value) for name, value in memory.items()}


def _require_names(values: Any) -> None:
    if not isinstance(values, Mapping):
        raise TypeError(
            f"parameters and memory are mappings of names to numbers and arrays, not a {type(values).__name__}"
        )
    if wrong := [name for name in values if not isinstance(name, str) or not name.isidentifier()]:
        raise TypeError(f"{wrong[0]!r} is no name that a function could have as an attribute")


def _floats(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value
    array = np.asarray(value)
    return array.astype(float) if array.dtype.kind in "iu" else value


@cache
def _compiled(function: Callable[..., Any]) -> CompiledFunction:
    return checked(function)


def record_of_values(values: Mapping[str, Any]) -> Record:
    """Values as one record (1,), a whole number of words long.

    Args:
        values: name -> number or array.

    Raises:
        TypeError: a value is neither.
    """
    arrays = {name: _array(name, value) for name, value in (values or _NOTHING).items()}
    sizes = [-(-array.nbytes // _WORD) * _WORD for array in arrays.values()]
    kind = np.dtype(
        {
            "names": list(arrays),
            "formats": [(array.dtype, array.shape) for array in arrays.values()],
            "offsets": [sum(sizes[:k]) for k in range(len(sizes))],
            "itemsize": sum(sizes) or _WORD,
        }
    )
    record = np.zeros(1, kind)
    for name, array in arrays.items():
        record[name][0] = array
    return record


def _array(name: str, value: Any) -> np.ndarray[Any, Any]:
    array = np.asarray(value)
    if array.dtype == np.bool_ and array.ndim:
        raise TypeError(f"{name} is an array of truth values; it takes one of numbers: .astype(int)")
    for kind in (np.bool_, np.int64, np.float64):
        if array.dtype.kind in "biuf" and np.can_cast(array.dtype, kind):
            return array.astype(kind)
    raise TypeError(f"{name} is a {type(value).__name__}; it takes a number or an array of numbers")
