"""Forces a user adds to a hull: one plain Python function on arrays, run inside every MuJoCo step.

    def tether(time, position, rotation, velocity, through_water):
        pull = -20.0 * (position - anchor)              # world axes [N]
        force = rotation.T @ pull                       # body axes
        return force[0], force[1], force[2], 0.0, 0.0, 0.0

Arguments:
    time: [s].
    position: p_WB (3,) [m].
    rotation: R_WB (3,3).
    velocity: nu (6,) = [v; w] [m/s, rad/s], body axes, over ground.
    through_water: nu_r (6,), the same relative to the water.

The six values returned are the wrench in body axes at the body origin [N, N m].

A force may take two more arguments, and keep a state besides:

    def bladder(time, position, rotation, velocity, through_water, command, activation, state=(0.0,)):
        lift = rotation.T @ np.array([0.0, 0.0, 9.81 * 1030.0 * state[0]])
        return (lift[0], lift[1], lift[2], 0.0, 0.0, 0.0), ((command[0] - state[0]) / 20.0,)

    command: (n,) of `data.ctrl`, of the actuators that its file has, in the file's order.
    activation: (m,) of `data.act`, of the same actuators: lagged commands, deflections of fins.
    state: (n,) what it keeps; its default says how many numbers, all 0 at the beginning. Such a force returns the
        wrench and the rates of its state, floats in a tuple or an array. MuJoCo integrates them with all else, as the
        activations of an actuator `<hull>:force_state` that pushes nothing: they are part of every snapshot.
        Such actuators are in no file, so no force sees them among the others.

What counts are the names of these three.

A function that numba can compile is compiled: it runs on every thread and costs what its arithmetic costs. Any other is
called as Python. It must depend on its arguments only: RK4 calls it four times a step, derivatives more often. What a
compiled one takes from outside, a global array say, is what it was when the model was loaded. The next `load_model`
takes it as it is then.

A function that raises, or returns what is not a number, gives a wrench that is not a number, compiled or not. MuJoCo
warns of it at that step, and a scenario ends as ERROR.
"""

from __future__ import annotations

import ctypes
import importlib
import secrets
from dataclasses import dataclass
from typing import Any

import llvmlite.binding
import numpy as np

from cube_sim.errors import ModelError
from cube_sim.vehicle.plugin import layout, user_force_code
from cube_sim.vehicle.plugin.user_force_kinds import ForceKind, UserForce

CAPACITY = 4096  # different functions in one process

_DOUBLES = ctypes.POINTER(ctypes.c_double)
_COUNTED = (_DOUBLES, ctypes.c_int64)
_SIGNATURE = ctypes.CFUNCTYPE(None, ctypes.c_double, *[_DOUBLES] * 5, *_COUNTED * 3, _DOUBLES)
_table = (ctypes.c_int64 * (CAPACITY + 1))()
_compiled: dict[str, int] = {}  # key of the machine code -> place in the table
_interpreted: dict[int, tuple[Any, int]] = {}  # id -> what must outlive the pointer, and its place
_size = 0


@dataclass(frozen=True)
class AtRest:
    """A hull at rest where it starts: p_WB (3,) [m], R_WB (3,3), the commands (n,) and activations (m,) it sees."""

    position: np.ndarray
    rotation: np.ndarray
    command: np.ndarray
    activation: np.ndarray


def publish() -> None:
    """Make the table known to the linker. Its first entry is `process_number`."""
    if _table[0] == 0:
        # A double without special values, which no other process draws.
        ctypes.cast(_table, _DOUBLES)[0] = 1.0 + secrets.randbits(52) * 2.0**-52
        llvmlite.binding.add_symbol(layout.FORCE_TABLE, ctypes.addressof(_table))


def process_number() -> float:
    """A number that no other process draws. A model carries it to say in which process its functions live."""
    publish()
    return ctypes.cast(_table, _DOUBLES)[0]


def register(function: UserForce, kind: ForceKind, name: str, at_rest: AtRest) -> int:
    """The function's place in the table, compiled if that is possible.

    Args:
        function: as in this module's examples.
        kind: of it.
        name: element to name in errors.
        at_rest: its hull where it starts.

    Raises:
        ModelError: it does not return six finite numbers for a hull at rest there, and the rates of its state.
    """
    _require_wrench(function, kind, name, at_rest)
    if id(function) in _interpreted:
        return _interpreted[id(function)][1]
    key = user_force_code.key_of(function)
    if key in _compiled:
        return _compiled[key]
    if _size >= CAPACITY:
        raise ModelError(name, f"is one too many: a process holds at most {CAPACITY} user forces")
    address = user_force_code.address(function, kind, key)
    if address is None:
        call = _wrap(function, kind)
        place = _add(int(ctypes.cast(call, ctypes.c_void_p).value or 0))
        _interpreted[id(function)] = (function, call), place
        return place
    place = _add(address)
    if key is not None:
        _compiled[key] = place
    return place


def _add(address: int) -> int:
    global _size
    _table[_size + 1] = address
    _size += 1
    return _size - 1


def resolve(path: str, name: str) -> UserForce:
    """The function that an MJCF text names.

    Args:
        path: ``package.module:function``.
        name: of the text, for errors.

    Raises:
        ModelError: the text reads otherwise, or there is no such function.
    """
    module, colon, attribute = path.strip().partition(":")
    if not colon:
        raise ModelError(name, f"is '{path}'; write package.module:function")
    try:
        return getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError) as error:
        raise ModelError(name, f"cannot be found: {error}") from None


def is_compiled(function: UserForce) -> bool:
    """Whether a registered function runs as machine code (else every call takes the interpreter's lock)."""
    return id(function) not in _interpreted


def _require_wrench(function: UserForce, kind: ForceKind, name: str, at_rest: AtRest) -> None:
    plain = getattr(function, "py_func", function)
    motion = at_rest.position.copy(), at_rest.rotation.copy(), np.zeros(6), np.zeros(6)
    try:
        answer = plain(0.0, *motion, *_others(kind, at_rest.command, at_rest.activation, np.zeros(kind.states)))
        wrench, rates = answer if kind.split else (answer, ())
        wrench, rates = np.asarray(wrench, dtype=float), np.asarray(rates, dtype=float)
    except Exception as error:
        text = f"fails for the hull at rest where it starts: {type(error).__name__}: {error}"
        raise ModelError(name, text) from error
    if wrench.shape != (6,):
        raise ModelError(name, f"returns shape {wrench.shape}; six values are right: Fx Fy Fz Mx My Mz")
    if rates.shape != (kind.states,):
        raise ModelError(name, f"returns rates of shape {rates.shape}; its state has {kind.states}")
    for values in (wrench, rates):
        if not np.all(np.isfinite(values)):
            listed = " ".join(f"{x:g}" for x in values)
            raise ModelError(name, f"returns {listed} for the hull at rest where it starts; finite numbers are right")


def _others(kind: ForceKind, command: np.ndarray, activation: np.ndarray, state: np.ndarray) -> tuple[np.ndarray, ...]:
    """What a force of that kind takes beside the motion, its own to write into."""
    if not kind.sees:
        return ()
    seen = command.copy(), activation.copy()
    return (*seen, state.copy()) if kind.states else seen


def _wrap(function: UserForce, kind: ForceKind) -> Any:
    told = False

    @_SIGNATURE
    def call(time, position, rotation, velocity, through_water, wrench, command, nu, activation, na, state, n, rates):
        nonlocal told
        out, moved = _array(wrench, 6), _array(rates, kind.states)
        try:
            answer = function(
                time,
                _array(position, 3).copy(),
                _array(rotation, 9).reshape(3, 3).copy(),
                _array(velocity, 6).copy(),
                _array(through_water, 6).copy(),
                *_others(kind, _array(command, nu), _array(activation, na), _array(state, n)),
            )
            if kind.split:
                out[:], moved[:] = answer
            else:
                out[:] = answer
        except BaseException:
            out[:], moved[:] = np.nan, np.nan
            if not told:  # MuJoCo resets the state and goes on, so that it would be told at every step
                told = True
                raise  # nowhere to: ctypes prints it

    return call


def _array(pointer: Any, n: int) -> np.ndarray:
    return np.ctypeslib.as_array(pointer, (n,)) if n else np.empty(0)
