"""Machine code of a user's force, kept on disk like that of the callbacks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cube_sim.native import object_cache
from cube_sim.native.fingerprint import fingerprint
from cube_sim.native.sources import source_digest

_NAME = "user_force"


def key_of(function: Callable[..., Any]) -> str | None:
    """Names the machine code of a force as it stands, and of the wrapper that this file puts around it.

    None where nobody can tell what the code depends on.
    """
    told = fingerprint(function)
    return told and f"{told} {source_digest(__name__)}"


def address(function: Callable[..., Any], key: str | None) -> int | None:
    """Address of ``void (time, position, rotation, velocity, through_water, wrench)``; None if numba cannot compile it.

    The values it takes from outside are those of now. Where Python would raise, the wrench is not a number.

    Args:
        function: the force.
        key: as `key_of` says; with None nothing is looked for on disk, or kept there.
    """
    try:
        if key is None:
            return object_cache.keep(_compile(function))
        found = object_cache.addresses(key, lambda: {_NAME: _compile(function)}, (_NAME,), runtime=_load_runtime)
    except _CannotCompileError:
        return None
    return found[_NAME]


class _CannotCompileError(Exception):
    """What the function does is beyond numba."""


def _load_runtime() -> None:
    """Make numba's memory management and linear algebra known to the linker, for code that leans on them."""
    from numba.core.registry import cpu_target
    from numba.core.runtime.nrt import rtsys

    rtsys.initialize(cpu_target.target_context)


def _compile(function: Callable[..., Any]) -> Any:
    import numba
    from numba import carray, types

    law = function if hasattr(function, "py_func") else numba.njit(boundscheck=True)(function)
    double, pointer, nan = types.float64, types.CPointer(types.float64), float("nan")

    def call(time, position, rotation, velocity, through_water, wrench):
        for i in range(6):
            wrench[i] = nan
        try:
            F = law(
                time,
                carray(position, (3,)),
                carray(rotation, (3, 3)),
                carray(velocity, (6,)),
                carray(through_water, (6,)),
            )
            # one by one: a tuple of different types cannot be indexed by a variable
            x, y, z, about_x, about_y, about_z = F[0], F[1], F[2], F[3], F[4], F[5]
            wrench[0], wrench[1], wrench[2] = x, y, z
            wrench[3], wrench[4], wrench[5] = about_x, about_y, about_z
        except Exception:  # what numba can catch
            wrench[0] = nan

    try:
        return numba.cfunc(types.void(double, pointer, pointer, pointer, pointer, pointer))(call)
    except (numba.core.errors.NumbaError, TypeError, NotImplementedError) as error:
        raise _CannotCompileError from error
