"""What the machine code of a compiled function is made from, as one digest, without numba.

numba's own stamp knows the file a function is written in only. Here it covers also

- the functions it calls from other files, to any depth;
- the constants and the fields of named tuples it takes from outside;
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
from types import CodeType
from typing import Any

from cube_sim.native.intrinsics import Intrinsic

_HOW = "compiled.py", "dispatching.py", "called.py", "lent.py", "intrinsics.py", "callee.py"
_PLAIN = bool, int, float, complex, str, bytes, tuple


def stamp_of(function: Callable[..., Any]) -> str:
    """Digest of all that a function's machine code is made from besides its own file."""
    told: list[tuple[str, Any]] = [("how", _how())]
    for name in sorted(_names(function.__code__)):
        value: Any = function.__globals__.get(name)
        if isinstance(value, Intrinsic):
            told.append((name, _content(value.definition.__code__.co_filename)))
        elif hasattr(value, "whole_stamp"):  # of a compiled function; the arrows point from there to here
            told.append((name, value.whole_stamp))
        elif isinstance(value, _PLAIN) or hasattr(type(value), "_numba_type_"):
            told.append((name, repr(value)))
        elif isinstance(value, type) and issubclass(value, tuple):
            told.append((name, repr(getattr(value, "_fields", None))))
        elif (file := _of_numba(value)) is not None:
            told.append((name, file))
    return hashlib.sha256(repr(told).encode()).hexdigest()


@cache
def file_stamp(file: str) -> tuple[int, int]:
    """What changes when a file does: its time and its size; zeros for none."""
    try:
        seen = Path(file).stat()
    except OSError:
        return 0, 0
    return seen.st_mtime_ns, seen.st_size


def _of_numba(value: Any) -> Any:
    """What somebody's own intrinsic or compiled function is made from; nothing is one where numba is not loaded."""
    if "numba.core.extending" not in sys.modules:
        return None
    from numba.core.extending import _Intrinsic
    from numba.core.registry import CPUDispatcher

    if isinstance(value, CPUDispatcher):
        file = getattr(getattr(value, "_cache", None), "_cache_file", None)
        return repr(getattr(file, "_source_stamp", None))
    if isinstance(value, _Intrinsic):  # what it does is said in a function inside it
        return _content(inspect.getfile(value._defn))
    return None


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
