"""The water inside this process's MuJoCo: compiled callbacks, installed once.

They are C function pointers: threads run them freely, without the interpreter's lock.
"""

from __future__ import annotations

import ctypes
import sys
import threading
from functools import cache
from importlib.metadata import version
from pathlib import Path

import llvmlite.binding
import mujoco

from cube_sim.errors import ModelError
from cube_sim.native import object_cache
from cube_sim.native.sources import source_digest
from cube_sim.vehicle.plugin import clock, guard, structs, user_forces

_CALLBACKS = "cube_sim.vehicle.plugin.callbacks"
_ARGUMENTS = {
    "passive": (ctypes.c_void_p, ctypes.c_void_p),
    "thrust": (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int),
    "servo": (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int),
}
_RESULTS = {"passive": None, "thrust": ctypes.c_double, "servo": ctypes.c_double}


def install() -> None:
    """Hook the water into this process's MuJoCo; a second call changes nothing.

    `load_model` does this. Call it yourself (`cube_sim.install()`) before you step a model that comes another way, from
    a saved .mjb file or a pickle. Until then its hull is dry and its thrusters give nothing.

    Raises:
        ModelError: another callback for passive forces, or for bias or dynamics of actuators, is installed; MuJoCo has
            room for one of each.
    """
    with _installing:
        _install()


_installing = threading.Lock()


def _install() -> None:
    functions = _callbacks()
    for name, role, setter, getter in (
        ("mjcb_passive", "passive", mujoco.set_mjcb_passive, mujoco.get_mjcb_passive),
        ("mjcb_act_bias", "thrust", mujoco.set_mjcb_act_bias, mujoco.get_mjcb_act_bias),
        ("mjcb_act_dyn", "servo", mujoco.set_mjcb_act_dyn, mujoco.get_mjcb_act_dyn),
    ):
        present = getter()
        if present is not None and _address(present) != _address(functions[role]):
            raise ModelError(
                name, "is already taken by another callback; clear it (set it to None) before loading water"
            )
        setter(functions[role])


@cache
def _callbacks() -> dict:
    library = next(path for path in Path(mujoco.__file__).parent.iterdir() if path.name.startswith(_library_name()))
    llvmlite.binding.load_library_permanently(str(library))
    guard.publish(str(library))
    clock.publish(str(library))
    user_forces.publish()
    layouts = structs.offsets("mjModel", structs.MODEL_FIELDS), structs.offsets("mjData", structs.DATA_FIELDS)
    off = mujoco.mjtDisableBit
    codes = {
        "no_gravity": int(off.mjDSBL_GRAVITY),
        "no_passive": int(off.mjDSBL_SPRING | off.mjDSBL_DAMPER),
        "pgs": int(mujoco.mjtSolver.mjSOL_PGS),
        "dynprm": int(mujoco.mjNDYN),
    }

    def build():
        from cube_sim.vehicle.plugin import callbacks

        return callbacks.build(*layouts, codes)

    found = object_cache.addresses(f"{_sources()} {layouts} {codes}", build, tuple(_ARGUMENTS))
    return {role: ctypes.CFUNCTYPE(_RESULTS[role], *_ARGUMENTS[role])(address) for role, address in found.items()}


def _library_name() -> str:
    return "mujoco.dll" if sys.platform == "win32" else "libmujoco."


def _sources() -> str:
    """Names the source of everything compiled into the callbacks, and the versions of what compiles it."""
    return f"{source_digest(_CALLBACKS)} numba {version('numba')} mujoco {mujoco.__version__}"


def _address(callback) -> int | None:
    try:
        return ctypes.cast(callback, ctypes.c_void_p).value
    except (ctypes.ArgumentError, TypeError):
        return None
