"""Forces a user adds to a hull: one plain Python function on arrays, run inside every MuJoCo step.

    def tether(time, position, rotation, velocity, through_water):
        pull = -20.0 * (position - anchor)              # world axes [N]
        force = rotation.T @ pull                       # body axes
        return force[0], force[1], force[2], 0.0, 0.0, 0.0

Arguments are the time [s], p_WB (3,) [m], R_WB (3,3), nu (6,) = [v; w] in body axes and nu_r (6,), the same relative to
the water; the six values returned are the wrench in body axes at the body origin [N, N m]. The function is compiled
when numba can (then it runs on every thread and costs what its arithmetic costs), and called as Python when not. It
must depend on its arguments only: RK4 calls it four times a step, derivatives more often. What it takes from outside is
frozen when it is compiled.
"""

from __future__ import annotations

import ctypes
import importlib
import secrets
from collections.abc import Callable, Sequence
from typing import Any

import llvmlite.binding
import numpy as np

from cube_sim.errors import ModelError

UserForce = Callable[[float, np.ndarray, np.ndarray, np.ndarray, np.ndarray], Sequence[float]]

SYMBOL = "cube_sim_force_table"
CAPACITY = 4096  # different functions in one process

_DOUBLES = ctypes.POINTER(ctypes.c_double)
_SIGNATURE = ctypes.CFUNCTYPE(None, ctypes.c_double, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES)
_table = (ctypes.c_int64 * (CAPACITY + 1))()
_kept: list[Any] = []  # what must outlive the pointers in the table
_known: dict[Any, int] = {}


def publish() -> None:
    """Make the table known to the linker. Its first entry is this process's own number."""
    if _table[0] == 0:
        # A double without special values, which no other process draws.
        ctypes.cast(_table, _DOUBLES)[0] = 1.0 + secrets.randbits(52) * 2.0**-52
        llvmlite.binding.add_symbol(SYMBOL, ctypes.addressof(_table))


def process_number() -> float:
    """What a model carries to say in which process its functions live."""
    publish()
    return ctypes.cast(_table, _DOUBLES)[0]


def register(function: UserForce, name: str) -> int:
    """The function's place in the table, compiled if that is possible.

    Args:
        function: as in this module's example.
        name: element to name in errors.

    Raises:
        ModelError: it does not return six numbers.
    """
    if function in _known:
        return _known[function]
    index = len(_kept)
    if index >= CAPACITY:
        raise ModelError(name, f"is one too many: a process holds at most {CAPACITY} user forces")
    _require_wrench(function, name)
    address, keep = _compile(function) or _wrap(function)
    _kept.append(keep)
    _table[index + 1] = address
    _known[function] = index
    return index


def resolve(path: str, name: str) -> UserForce:
    """The function that an MJCF text ``package.module:function`` names."""
    module, colon, attribute = path.strip().partition(":")
    if not colon:
        raise ModelError(name, f"is '{path}'; write package.module:function")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise ModelError(name, f"cannot be found: {error}") from None


def is_compiled(function: UserForce) -> bool:
    """Whether a registered function runs as machine code (else every call takes the interpreter's lock)."""
    return not isinstance(_kept[_known[function]], _SIGNATURE)


def _require_wrench(function: UserForce, name: str) -> None:
    try:
        wrench = np.asarray(function(0.0, np.zeros(3), np.eye(3), np.zeros(6), np.zeros(6)), dtype=float)
    except Exception as error:
        raise ModelError(name, f"fails at rest at the origin: {type(error).__name__}: {error}") from error
    if wrench.shape != (6,):
        raise ModelError(name, f"returns shape {wrench.shape}; six values are right: Fx Fy Fz Mx My Mz")


def _compile(function: UserForce) -> tuple[int, Any] | None:
    import numba
    from numba import carray, types

    law = numba.njit(function) if not hasattr(function, "py_func") else function
    double, pointer = types.float64, types.CPointer(types.float64)

    def call(time, position, rotation, velocity, through_water, wrench):
        F = law(
            time,
            carray(position, (3,)),
            carray(rotation, (3, 3)),
            carray(velocity, (6,)),
            carray(through_water, (6,)),
        )
        for i in range(6):
            wrench[i] = F[i]

    try:
        compiled = numba.cfunc(types.void(double, pointer, pointer, pointer, pointer, pointer))(call)
    except numba.core.errors.NumbaError:
        return None
    return compiled.address, compiled


def _wrap(function: UserForce) -> tuple[int, Any]:
    @_SIGNATURE
    def call(time, position, rotation, velocity, through_water, wrench):
        out = np.ctypeslib.as_array(wrench, (6,))
        try:
            out[:] = function(
                time,
                np.ctypeslib.as_array(position, (3,)).copy(),
                np.ctypeslib.as_array(rotation, (3, 3)).copy(),
                np.ctypeslib.as_array(velocity, (6,)).copy(),
                np.ctypeslib.as_array(through_water, (6,)).copy(),
            )
        except BaseException:
            out[:] = np.nan  # MuJoCo stops at the first value that is not a number; ctypes prints the traceback
            raise

    return int(ctypes.cast(call, ctypes.c_void_p).value or 0), call
