"""numba's runtime in C, without numba: machine code that numba has made once needs no more of it to run.

The libraries are those of the installed numba. Whoever imports it later finds it as if nothing had been loaded before.
"""

from __future__ import annotations

import builtins
import ctypes
import pickle
import sys
from functools import cache
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import llvmlite.binding as llvm


def make_known() -> None:
    """Tell the linker the names that numba's machine code takes from outside.

    Raises:
        ImportError: numba is not installed as it is expected to be.
    """
    _make_known()


@cache
def _make_known() -> None:
    llvm.add_symbol("_Py_NoneStruct", id(None))
    for library in (_library("numba._helperlib"), _library("numba._dynfunc")):
        for name, address in library.c_helpers.items():
            llvm.add_symbol(f"numba_{name}", address)
    for name, address in _library("numba.core.runtime._nrt_python").c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)
    for each in vars(builtins).values():
        if isinstance(each, type) and issubclass(each, BaseException):
            llvm.add_symbol(f"PyExc_{each.__name__}", id(each))
    if "numba" not in sys.modules:  # its own would import it
        llvm.add_symbol("numba_unpickle", ctypes.cast(_unpickle, ctypes.c_void_p).value)


def environment(namespace: dict[str, Any], constants: list[Any]) -> Any:
    """What machine code of numba's takes from Python: an object whose address it is told."""
    made = _library("numba._dynfunc").Environment(namespace)
    made.consts.extend(constants)
    return made


def python_function(name: str, address: int, env: Any, kept: tuple[Any, ...]) -> Any:
    """The door for Python in front of machine code, which numba has put there.

    Args:
        name: of the function.
        address: of the door.
        env: of `environment`.
        kept: what lives as long as the function.
    """
    module = sys.modules[__name__]
    return _library("numba._dynfunc").make_function(module, name, "", address, env, kept)


@ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)
def _unpickle(address: int, count: int, digest: int) -> Any:
    """An object that machine code carries along in bytes, the type of arrays for one; the same one each time."""
    return _unpickled(address, count)


@cache
def _unpickled(address: int, count: int) -> Any:
    return pickle.loads(ctypes.string_at(address, count))


@cache
def _library(name: str) -> ModuleType:
    if name in sys.modules:
        return sys.modules[name]
    found = find_spec("numba")  # which imports nothing
    if found is None or found.origin is None:
        raise ImportError("numba is not installed")
    folder = Path(found.origin).parent.joinpath(*name.split(".")[1:-1])
    spec = PathFinder.find_spec(name, [str(folder)])
    if spec is None or spec.loader is None:
        raise ImportError(f"{folder} holds no {name}")
    library = module_from_spec(spec)
    spec.loader.exec_module(library)
    sys.modules.pop(name, None)  # its package is not there
    return library
