"""What the machine code of a compiled function is made from, as one digest, without numba.

numba's own stamp knows the file a function is written in only. Here it covers also

- the functions it calls from other files, to any depth;
- the constants, arrays and fields of named tuples it takes from outside;
- the files of somebody's own modules that it names;
- the files of the intrinsics it uses;
- the files that say how it is compiled.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from sysconfig import get_path
from types import CodeType, ModuleType
from typing import Any

import numpy as np

from cube_sim.native.intrinsics import Intrinsic

_HOW = "compiled.py", "dispatching.py", "called.py", "lent.py", "intrinsics.py", "callee.py"
_PLAIN = bool, int, float, complex, str, bytes, tuple


def stamp_of(function: Callable[..., Any], callers: tuple[Any, ...] = ()) -> str:
    """Digest of all that a function's machine code is made from besides its own file.

    Args:
        function: the function.
        callers: plain functions on whose behalf this is asked, which may be called again.
    """
    told: list[tuple[str, Any]] = [("how", _how())]
    for name in sorted(_names(function.__code__)):
        value: Any = function.__globals__.get(name)
        if isinstance(value, Intrinsic):
            told.append((name, _content(value.definition.__code__.co_filename)))
        elif hasattr(value, "whole_stamp"):  # of a compiled function; the arrows point from there to here
            told.append((name, value.whole_stamp))
        elif (made_from := _of_numba(value, (*callers, function))) is not None:
            told.append((name, made_from))
        elif isinstance(value, _PLAIN) or hasattr(type(value), "_numba_type_"):
            told.append((name, repr(value)))
        elif isinstance(value, type) and issubclass(value, tuple):
            told.append((name, repr(getattr(value, "_fields", None))))
        elif isinstance(value, np.ndarray):
            told.append((name, (value.dtype.str, value.shape, value.tobytes())))
        elif isinstance(value, ModuleType) and (file := _file_of(value)):
            told.append((name, _content(file)))
    return hashlib.sha256(repr(told).encode()).hexdigest()


@cache
def file_stamp(file: str) -> tuple[int, int]:
    """What changes when a file does: its time and its size; zeros for none."""
    try:
        seen = Path(file).stat()
    except OSError:
        return 0, 0
    return seen.st_mtime_ns, seen.st_size


def _of_numba(value: Any, callers: tuple[Any, ...]) -> Any:
    """What somebody's own intrinsic or compiled function is made from; nothing is one where numba is not loaded."""
    if "numba.core.extending" not in sys.modules:
        return None
    from numba.core.extending import _Intrinsic
    from numba.core.registry import CPUDispatcher

    if isinstance(value, CPUDispatcher):
        file = value.py_func.__code__.co_filename
        if value.py_func in callers:
            return "itself"
        return (_content(file) if Path(file).is_file() else repr(value)), stamp_of(value.py_func, callers)
    if isinstance(value, _Intrinsic):  # what it does is said in a function inside it
        return _content(inspect.getfile(value._defn))
    return None


@cache
def _file_of(module: ModuleType) -> str:
    """Where somebody's own module lies, whose functions may be called by its name; "" of those that are installed."""
    file = getattr(module, "__file__", None) or ""
    installed = any(
        Path(file).is_relative_to(get_path(kind)) for kind in ("stdlib", "platstdlib", "purelib", "platlib")
    )
    return "" if installed or not file.endswith(".py") else file


@cache
def _how() -> str:
    return "".join(_content(str(Path(__file__).with_name(name))) for name in _HOW)


@cache
def _content(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


def _names(code: CodeType) -> set[str]:
    """Global names a function's code uses, those of functions inside it too."""
    inside = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*(_names(inner) for inner in inside))
