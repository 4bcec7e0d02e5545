"""Machine code of a user's force, kept on disk like that of the callbacks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cube_sim.native import object_cache
from cube_sim.native.fingerprint import fingerprint
from cube_sim.native.sources import source_digest
from cube_sim.vehicle.plugin.user_force_kinds import ForceKind

_NAME = "user_force"


def key_of(function: Callable[..., Any]) -> str | None:
    """Names the machine code of a force as it stands, and of the wrapper that this file puts around it.

    None where nobody can tell what the code depends on.
    """
    told = fingerprint(function)
    return told and f"{told} {source_digest(__name__)}"


def address(function: Callable[..., Any], kind: ForceKind, key: str | None) -> int | None:
    """Address of the wrapper; None if numba cannot compile it.

    The wrapper is ``void (time, position, rotation, velocity, through_water, wrench, command, nu, activation, na,
    state, n, rates)``: doubles, pointers to doubles, and int64 where a number of them is meant.

    The values it takes from outside are those of now. Where Python would raise, the wrench is not a number.

    Args:
        function: the force.
        kind: of it.
        key: as `key_of` says; with None nothing is looked for on disk, or kept there.
    """
    try:
        if key is None:
            return object_cache.keep(_compile(function, kind))
        found = object_cache.addresses(key, lambda: {_NAME: _compile(function, kind)}, (_NAME,), runtime=_load_runtime)
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


def _compile(function: Callable[..., Any], kind: ForceKind) -> Any:
    import numba
    from numba import types

    law = function if hasattr(function, "py_func") else numba.njit(boundscheck=True)(function)
    double, pointer, count = types.float64, types.CPointer(types.float64), types.int64
    counted = (pointer, count) * 3
    signature = types.void(double, *[pointer] * 5, *counted, pointer)
    try:
        return numba.cfunc(signature)(_wrapper(law, kind))
    except (numba.core.errors.NumbaError, TypeError, NotImplementedError) as error:
        raise _CannotCompileError from error


def _wrapper(law: Any, kind: ForceKind) -> Callable[..., None]:
    """The function of that signature around a force that numba has taken on."""
    import numba
    from numba import carray

    nan = float("nan")

    @numba.njit
    def put_wrench(wrench, F):
        # one by one: a tuple of different types cannot be indexed by a variable
        x, y, z, about_x, about_y, about_z = F[0], F[1], F[2], F[3], F[4], F[5]
        wrench[0], wrench[1], wrench[2] = x, y, z
        wrench[3], wrench[4], wrench[5] = about_x, about_y, about_z

    @numba.njit
    def motion_of(position, rotation, velocity, through_water):
        place, turn = carray(position, (3,)), carray(rotation, (3, 3))
        return place, turn, carray(velocity, (6,)), carray(through_water, (6,))

    def blind(time, position, rotation, velocity, through_water, wrench, command, nu, activation, na, state, n, rates):
        for i in range(6):
            wrench[i] = nan
        try:
            motion = motion_of(position, rotation, velocity, through_water)
            put_wrench(wrench, law(time, motion[0], motion[1], motion[2], motion[3]))
        except Exception:  # what numba can catch
            wrench[0] = nan

    def seeing(time, position, rotation, velocity, through_water, wrench, command, nu, activation, na, state, n, rates):
        for i in range(6):
            wrench[i] = nan
        try:
            motion = motion_of(position, rotation, velocity, through_water)
            commands, activations = carray(command, (nu,)).copy(), carray(activation, (na,)).copy()
            put_wrench(wrench, law(time, motion[0], motion[1], motion[2], motion[3], commands, activations))
        except Exception:
            wrench[0] = nan

    def keeping(
        time, position, rotation, velocity, through_water, wrench, command, nu, activation, na, state, n, rates
    ):
        for i in range(6):
            wrench[i] = nan
        for i in range(n):
            rates[i] = nan
        try:
            motion = motion_of(position, rotation, velocity, through_water)
            commands, activations = carray(command, (nu,)).copy(), carray(activation, (na,)).copy()
            kept = carray(state, (n,)).copy()
            F, moved = law(time, motion[0], motion[1], motion[2], motion[3], commands, activations, kept)
            put_wrench(wrench, F)
            for i in range(n):
                rates[i] = moved[i]
        except Exception:
            wrench[0] = nan

    if kind.states:
        return keeping
    return seeing if kind.sees else blind
