"""One way to compile a hot law: numba, cached on disk, with the plain function kept as `.py_func`."""

from __future__ import annotations

import hashlib
import inspect
import pickle
from collections.abc import Callable
from pathlib import Path
from types import CodeType
from typing import Any

import numba
from numba.core import cgutils, types
from numba.core.extending import _Intrinsic
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array


@intrinsic
def borrowed(typingctx: Any, array: Any) -> Any:
    """The same array without a share in its memory: views of it, and handing them on, cost no reference counting.

    For arguments of a compiled function only: its caller holds them until it returns.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        view = make_array(signature.args[0])(context, builder, args[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), codegen


@intrinsic
def cut(typingctx: Any, array: Any, at: Any, shape: Any, dtype: Any) -> Any:
    """Entries of a flat array from ``at`` on as an array of a shape (tuple of int), without a share in its memory.

    ``dtype`` is np.float64 or np.int64, whose eight bytes are read as they are. Nothing is checked, and who holds the
    flat array must hold it as long as the piece is used.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        flat = make_array(signature.args[0])(context, builder, args[0])
        result = make_array(signature.return_type)(context, builder)
        eight = context.get_constant(types.intp, 8)
        sizes, strides = cgutils.unpack_tuple(builder, args[2]), [eight]
        for extent in reversed(sizes[1:]):
            strides.insert(0, builder.mul(strides[0], extent))
        start = builder.bitcast(builder.gep(flat.data, [args[1]]), result.data.type)
        populate_array(result, start, sizes, strides, eight, None)
        return result._getvalue()

    whole = types.UniTuple(types.intp, len(shape))
    return types.Array(dtype.dtype, len(shape), "C")(array, types.intp, whole, dtype), codegen


@intrinsic
def bits(typingctx: Any, number: Any) -> Any:
    """The eight bytes of a float as an int: those of positive floats are in the same order."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.bitcast(args[0], context.get_value_type(types.int64))

    return types.int64(types.float64), codegen


def compiled(function: Callable[..., Any]) -> Any:
    """Compile `function` at its first call; the uncompiled one stays reachable as `.py_func`, the reference in tests.

    No fast-math: results are the same bits on every run, and equal to the reference's up to rounding.

    numba's cache looks at the file a function is written in only, and would go on using the old machine code of
    what the function calls from other files. Here its stamp also covers those functions, to any depth, the constants
    they use and the files of the intrinsics; functions must therefore be defined before those that call them.
    """
    return _compile(function)


def inlined(function: Callable[..., Any]) -> Any:
    """The same for a function called from one place: compiled as a part of its caller, not once more by itself."""
    return _compile(function, inline="always")


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    # Nothing calls these functions from C; a door for it would take a tenth of the time compiling takes.
    dispatcher = numba.njit(cache=True, fastmath=False, error_model="numpy", no_cfunc_wrapper=True, **options)(function)
    file = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if file is not None:  # numba has no public way to say what a cached function depends on
        file._source_stamp = (file._source_stamp, _fingerprint(function))
        file._load_index = _forgiving(file._load_index)
    return dispatcher


def _forgiving(load: Callable[[], dict[Any, Any]]) -> Callable[[], dict[Any, Any]]:
    """Read a cache's index, an unreadable one as empty.

    An index names the types of arguments. Left by an earlier version, it may name a type that is no more: the
    functions are compiled again then, as for any other change.
    """

    def load_or_forget() -> dict[Any, Any]:
        try:
            return load()
        except (AttributeError, ImportError, TypeError, ValueError, EOFError, pickle.UnpicklingError):
            return {}

    return load_or_forget


def _fingerprint(function: Callable[..., Any]) -> str:
    """Digest of what a function takes from outside: stamps of functions, files of intrinsics, values of constants."""
    told = []
    for name in sorted(_names(function.__code__)):
        value = function.__globals__.get(name)
        if isinstance(value, numba.core.registry.CPUDispatcher):
            file = getattr(getattr(value, "_cache", None), "_cache_file", None)
            told.append((name, repr(getattr(file, "_source_stamp", None))))
        elif isinstance(value, _Intrinsic):  # what it does is said in a function inside it
            told.append((name, Path(inspect.getfile(value._defn)).read_bytes()))
        elif isinstance(value, bool | int | float | complex | str | bytes | tuple):
            told.append((name, repr(value)))
        elif isinstance(value, type) and issubclass(value, tuple):
            told.append((name, repr(getattr(value, "_fields", None))))
    return hashlib.sha256(repr(told).encode()).hexdigest()


def _names(code: CodeType) -> set[str]:
    """Global names a function's code uses, those of functions inside it too."""
    inside = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*(_names(inner) for inner in inside))
