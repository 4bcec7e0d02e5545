"""Machine code that numba has made, kept on disk so that another process calls it without numba.

numba takes half a second to be imported, as long again before it loads the first function from its own cache. The
machine code is whole: numba's door for Python is part of it, and its runtime is two small libraries in C. So the bits
are numba's own, and a call costs what it costs there.

A file is named by the function and the kinds of its arguments, and holds what it was made from. So a stale one is
written over, and never used.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import pickle
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm

from cube_sim.native import numba_runtime, object_cache

_SAYS_NOTHING = "NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS"
"""Settings of numba's that change no machine code."""


@dataclass(frozen=True)
class MachineCode:
    """Machine code of a function, and the words to use it by.

    Attributes:
        machine_code: an object file.
        entry: name of the function in it.
        door: name of the function for Python in it.
        answers: types of what it answers, by numba's names.
        environments: for each name in it that is to hold the address of an environment, what that holds.
        outside: names it takes from outside.
    """

    machine_code: bytes
    entry: str
    door: str
    answers: tuple[str, ...]
    environments: tuple[tuple[str, list[Any]], ...]
    outside: tuple[str, ...]


@dataclass(frozen=True)
class Door:
    """A function ready to be called.

    Attributes:
        call: for Python.
        address: for compiled code.
        answers: types of what it answers, by numba's names.
    """

    call: Callable[..., Any]
    address: int
    answers: tuple[str, ...]


def load(name: str, kinds: str, stamp: str) -> Door | None:
    """The code of a function from disk; None where there is none, or none that was made from this.

    Args:
        name: of the function and its module.
        kinds: of its arguments.
        stamp: what its code is made from.
    """
    if not usual():
        return None
    for folder in object_cache.cache_folders():
        content = object_cache.read(folder / _file_name(name, kinds))
        code = None if content is None else _unpacked(content, _whole(stamp))
        if code is not None:
            return _opened(name, code)
    return None


def on_disk(name: str, stamp: str) -> bool:
    """Whether there is code of a function, made from what stands there now, for whatever arguments."""
    pattern, told = f"{_beginning(name)}-*.door", _whole(stamp)
    files = (file for folder in object_cache.cache_folders() for file in folder.glob(pattern))
    return usual() and any(
        (content := object_cache.read(file)) is not None and _unpacked(content, told) is not None for file in files
    )


def keep(name: str, kinds: str, stamp: str, code: MachineCode) -> None:
    """Leave code for other processes, where it can be told to them."""
    if not usual():
        return
    try:
        content = pickle.dumps((_whole(stamp), code.__dict__))
    except Exception:  # whatever objects of Python's it takes along
        return
    for folder in object_cache.cache_folders():
        if object_cache.write(folder / _file_name(name, kinds), content):
            return


def _unpacked(content: bytes, stamp: str) -> MachineCode | None:
    try:
        made_from, code = pickle.loads(content)
        return MachineCode(**code) if made_from == stamp else None
    except Exception:  # of an earlier version, which may name what is no more
        return None


def _opened(name: str, code: MachineCode) -> Door | None:
    numba_runtime.make_known()
    if any(llvm.address_of_symbol(each) is None for each in code.outside):
        return None
    engine = object_cache.linked(code.machine_code)
    made = []
    for place, constants in code.environments:
        address = engine.get_global_value_address(place)
        if address:
            made.append(numba_runtime.environment({}, constants))
            ctypes.c_void_p.from_address(address).value = id(made[-1])
    env = made[0] if made else numba_runtime.environment({}, [])
    address, door = engine.get_function_address(code.entry), engine.get_function_address(code.door)
    if not address or not door:
        return None
    _held.append(made)
    return Door(numba_runtime.python_function(name.rpartition(".")[2], door, env, ()), address, code.answers)


_held: list[Any] = []
"""Objects whose addresses machine code knows, which lives as long as the process."""


def outside_of(code: bytes) -> tuple[str, ...]:
    """Names that LLVM's code takes from outside, but for those of Python, which is there.

    Args:
        code: LLVM's bitcode.
    """
    module = llvm.parse_bitcode(code)
    names = [f.name for f in module.functions if f.is_declaration] + [
        g.name for g in module.global_variables if g.is_declaration
    ]
    return tuple(name for name in names if not re.match(r"llvm\.|_?Py", name))


def answers_of(kinds: Sequence[Any]) -> tuple[str, ...]:
    """Types by numba's names, which for numbers are numpy's."""
    return tuple(str(kind) for kind in kinds)


def _whole(stamp: str) -> str:
    return hashlib.sha256(f"{stamp}\n{_made_by()}".encode()).hexdigest()


@cache
def _made_by() -> str:
    """What makes machine code: this processor, these versions, this file."""
    versions = (sys.version, *(f"{name} {version(name)}" for name in ("numba", "llvmlite", "numpy")))
    here = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()
    return repr((versions, object_cache.processor(), here))


def usual() -> bool:
    """Whether numba is set up as it comes: somebody who looks into what it does wants it to do it."""
    told = any(name.startswith("NUMBA_") and name not in _SAYS_NOTHING for name in os.environ)
    return not told and not Path(".numba_config.yaml").exists()


def _file_name(name: str, kinds: str) -> str:
    return f"{_beginning(name)}-{hashlib.sha256(kinds.encode()).hexdigest()[:20]}.door"


def _beginning(name: str) -> str:
    """Of a file's name: the function's, and what tells it from others of that name."""
    plain, told = re.sub(r"\W", "_", name.rpartition(".")[2]), hashlib.sha256(name.encode()).hexdigest()[:8]
    return f"{plain}-{told}"
