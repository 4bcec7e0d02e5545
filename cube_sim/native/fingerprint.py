"""What the machine code of a Python function depends on, as one digest.

numba freezes what a function takes from outside when it compiles it. Two functions of equal digests compile to the same
code, in this process and in the next.
"""

from __future__ import annotations

import dis
import hashlib
import sys
from collections.abc import Callable, Iterator
from importlib.metadata import version
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

_RELEASED = ("numpy", "numba", "math", "cmath", "operator", "builtins")  # their versions say what they hold


class _UnknownError(Exception):
    """A value whose part in the machine code nobody can tell."""


def fingerprint(function: Callable[..., Any]) -> str | None:
    """Digest of a function's code, of all it takes from outside, and of the versions of what compiles it.

    Values from outside are numbers, texts, arrays, tuples of them, modules and other functions, to any depth.

    Returns:
        None for a function that takes something else from outside, or is none written in Python.
    """
    versions = (sys.version, *(f"{name} {version(name)}" for name in ("numba", "llvmlite", "numpy")))
    try:
        told = repr((versions, _value(function, set())))
    except _UnknownError:
        return None
    return hashlib.sha256(told.encode()).hexdigest()


def _value(value: Any, seen: set[int]) -> tuple:
    if _is_dispatcher(value):
        options = repr(sorted(value.targetoptions.items()))
        return ("dispatcher", options, _value(value.py_func, seen))
    kind = (type(value).__module__, type(value).__qualname__)
    if value is None or isinstance(value, bool | int | float | complex | str | bytes | np.generic | np.dtype):
        return (*kind, repr(value))
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        flags = value.flags.c_contiguous, value.flags.f_contiguous
        return (*kind, value.dtype.str, value.shape, flags, hashlib.sha256(value.tobytes()).hexdigest())
    if isinstance(value, tuple):
        return (*kind, *(_value(item, seen) for item in value))
    if name := _released_name(value):
        return ("of a release", *name)
    if isinstance(value, FunctionType):
        return _function(value, seen)
    raise _UnknownError


def _released_name(value: Any) -> tuple[str, str] | None:
    """Where a function or type of Python, numpy or numba can be imported from."""
    module = getattr(value, "__module__", None) or type(value).__module__
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", "")
    root = module.partition(".")[0]
    released = root in _RELEASED or root in sys.stdlib_module_names
    return (module, name) if released and name and getattr(sys.modules.get(module), name, None) is value else None


def _function(function: FunctionType, seen: set[int]) -> tuple:
    if id(function) in seen:
        return ("again", function.__qualname__)
    seen.add(id(function))
    code = function.__code__
    cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
    outside = {name: _cell(cell) for name, cell in cells}
    namespace = function.__globals__
    outside |= {name: namespace[name] for name in sorted(_globals(code)) if name in namespace}
    told = tuple((name, _outside(value, code, seen)) for name, value in outside.items())
    defaults = (*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).items())
    return ("function", _code(code), told, _value(defaults, seen))


def _cell(cell: Any) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # empty
        raise _UnknownError from None


def _outside(value: Any, code: CodeType, seen: set[int]) -> tuple:
    """A value from outside; of a module, what the function may take of it."""
    if not isinstance(value, ModuleType):
        return _value(value, seen)
    if value.__name__.partition(".")[0] in _RELEASED:
        return ("module", value.__name__)
    taken = [name for name in _attributes(code) if hasattr(value, name)]
    return ("module", value.__name__, *((name, _outside(getattr(value, name), code, seen)) for name in taken))


def _code(code: CodeType) -> tuple:
    constants = tuple(_code(c) if isinstance(c, CodeType) else (type(c).__name__, repr(c)) for c in code.co_consts)
    names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
    return (code.co_code.hex(), constants, names, code.co_argcount, code.co_kwonlyargcount, code.co_flags)


def _codes(code: CodeType) -> Iterator[CodeType]:
    """A function's code and that of the functions inside it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)


def _globals(code: CodeType) -> set[str]:
    read = ("LOAD_GLOBAL", "LOAD_NAME")
    return {step.argval for part in _codes(code) for step in dis.get_instructions(part) if step.opname in read}


def _attributes(code: CodeType) -> list[str]:
    return sorted({name for part in _codes(code) for name in part.co_names})


def _is_dispatcher(value: Any) -> bool:
    return hasattr(value, "py_func") and hasattr(value, "targetoptions")
