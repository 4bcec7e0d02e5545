"""The compiled laws as readable Python: the very source that numba compiles, the callbacks on MuJoCo's own memory.

Every module the laws are made of is executed once more with numba and `cube_sim.native.compiled` replaced by
nothing, and `cube_sim.vehicle.plugin.memory`, which is written for the code generator, by reads and writes through
ctypes.
"""

from __future__ import annotations

import builtins
import ctypes
import importlib.util
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace

import mujoco
import numpy as np

from cube_sim.vehicle.plugin import hook, layout, structs, user_forces

_LIBRARY = ctypes.CDLL(
    str(next(p for p in Path(mujoco.__file__).parent.iterdir() if p.name.startswith(hook._library_name())))
)


def plain(name: str) -> ModuleType:
    """A module of cube_sim with nothing in it compiled, nor in what it imports."""
    return _Plain().module(name)


@cache
def callbacks() -> dict:
    """`passive(model, data)` and `thrust(model, data, actuator)` on addresses, as `hook` builds them, uncompiled."""
    layouts = structs.offsets("mjModel", structs.MODEL_FIELDS), structs.offsets("mjData", structs.DATA_FIELDS)
    off = mujoco.mjtDisableBit
    codes = {
        "no_gravity": int(off.mjDSBL_GRAVITY),
        "no_passive": int(off.mjDSBL_SPRING | off.mjDSBL_DAMPER),
        "pgs": int(mujoco.mjtSolver.mjSOL_PGS),
        "dynprm": int(mujoco.mjNDYN),
    }
    return plain("cube_sim.vehicle.plugin.callbacks").build(*layouts, codes)


def vector(address: int, n: int) -> np.ndarray:
    return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(ctypes.c_double)), (n,))


def _put(address: int, i: int, value: float) -> None:
    vector(address, i + 1)[i] = value


def _call_force(address, time, position, rotation, nu, nu_r, seen):
    at_rest = [np.array(x) for x in (nu, nu_r, np.zeros(6))]
    pointers = [ctypes.cast(a, user_forces._DOUBLES) for a in (position, rotation)]
    pointers += [a.ctypes.data_as(user_forces._DOUBLES) for a in at_rest]
    others = [each if i in (1, 3, 5) else ctypes.cast(each, user_forces._DOUBLES) for i, each in enumerate(seen)]
    user_forces._SIGNATURE(address)(time, *pointers, *others)
    return tuple(at_rest[2].tolist())


def _call_in_c(address, given, answer):
    doubles = ctypes.POINTER(ctypes.c_double)
    law = ctypes.CFUNCTYPE(ctypes.c_int64, doubles, doubles)(int(address))
    return law(given.ctypes.data_as(doubles), answer.ctypes.data_as(doubles))


def _columns_times(address: int, x: tuple[float, ...]) -> tuple[float, ...]:
    columns = vector(address, 36).reshape(6, 6)
    return tuple(sum(float(columns[j, i]) * x[j] for j in range(6)) for i in range(6))


_ROOM, _INERTIA = np.zeros(layout.HULL_SIZE), np.zeros(36)
_MEMORY = SimpleNamespace(
    double=lambda address, i: ctypes.c_double.from_address(address + 8 * i).value,
    columns_times=_columns_times,
    integer=lambda address, i: ctypes.c_int32.from_address(address + 4 * i).value,
    field=lambda address, offset: ctypes.c_int64.from_address(address + offset).value,
    put=_put,
    vector=vector,
    matrix=lambda address, rows, columns: vector(address, rows * columns).reshape(rows, columns),
    force_table=lambda: ctypes.addressof(user_forces._table),
    call_force=_call_force,
    room_for_hull=lambda: _ROOM.ctypes.data,
    room_for_inertia=lambda: _INERTIA.ctypes.data,
)


class _Kind:
    """A type of numba's: called to make a signature, it is nothing."""

    def __call__(self, *arguments):
        return self


def _external(name: str, signature: object):
    function = getattr(_LIBRARY, name)
    function.argtypes, function.restype = (ctypes.c_void_p, ctypes.c_void_p), None
    return function


def _as_it_is(*arguments, **options):
    return arguments[0] if arguments and callable(arguments[0]) and not isinstance(arguments[0], _Kind) else _as_it_is


_TYPES = SimpleNamespace(
    ExternalFunction=_external, void=_Kind(), double=_Kind(), int64=_Kind(), int32=_Kind(), float64=_Kind()
)
_NUMBA = SimpleNamespace(njit=_as_it_is, cfunc=_as_it_is, types=_TYPES)


_PLAIN = (
    "cube_sim.tuples",
    "cube_sim.vehicle.laws.",
    "cube_sim.vehicle.plugin.ballast_record",
    "cube_sim.vehicle.plugin.inertia",
    "cube_sim.vehicle.plugin.curve_record",
    "cube_sim.vehicle.plugin.lift_record",
    "cube_sim.vehicle.plugin.link_inertia",
    "cube_sim.vehicle.plugin.link_water",
    "cube_sim.vehicle.plugin.propeller_wrench",
    "cube_sim.vehicle.plugin.under_water",
    "cube_sim.vehicle.plugin.water_on_body",
    "cube_sim.guidance.",
    "cube_sim.navigation.",
    "cube_sim.control.",
)
"""How the names of modules begin that are executed once more when another of them imports them."""


class _Plain:
    """One set of modules that see only each other."""

    def __init__(self) -> None:
        self._modules: dict[str, object] = {
            "numba": _NUMBA,
            "cube_sim.native.compiled": SimpleNamespace(compiled=_as_it_is, inlined=_as_it_is, call_in_c=_call_in_c),
            "cube_sim.vehicle.plugin.memory": _MEMORY,
        }

    def module(self, name: str) -> ModuleType:
        spec = importlib.util.find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        module = ModuleType(name)
        self._modules[name] = module
        module.__dict__["__builtins__"] = {**vars(builtins), "__import__": self._import}
        source = Path(spec.origin).read_text(encoding="utf-8")
        exec(compile(source, spec.origin, "exec", dont_inherit=True), module.__dict__)
        return module

    def _import(self, name, globals_=None, locals_=None, fromlist=(), level=0):
        if name not in self._modules and name.startswith(_PLAIN):
            self.module(name)
        if name in self._modules:
            return self._modules[name]
        return builtins.__import__(name, globals_, locals_, fromlist, level)
