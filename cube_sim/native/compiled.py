"""One way to compile a hot law: numba, cached on disk, with the plain function kept as `.py_func`.

Machine code on disk is used again until something changes that it was made from (`cube_sim.native.stamps`). Functions
must be defined before those that call them.

numba is imported when something has to be compiled: what is on disk is called without it (`cube_sim.native.doors`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from cube_sim.native.function import CompiledFunction
from cube_sim.native.intrinsics import Intrinsic


@Intrinsic
def borrowed(typingctx: Any, array: Any) -> Any:
    """The same array without a share in its memory: views of it cost no reference counting, nor does handing them on.

    For arguments of a compiled function only: its caller holds them until it returns.
    """
    from numba.core import cgutils
    from numba.np.arrayobj import make_array

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        view = make_array(signature.args[0])(context, builder, args[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), codegen


@Intrinsic
def cut(typingctx: Any, array: Any, at: Any, shape: Any, dtype: Any) -> Any:
    """Entries of a flat array as an array of another shape, without a share in its memory.

    Nothing is checked. Whoever holds the flat array must hold it as long as the piece is used.

    Args:
        typingctx: numba's, not given by the caller.
        array: (n,) float64.
        at: index of the first entry.
        shape: of the result, a tuple of int.
        dtype: np.float64 or np.int64, whose eight bytes are read as they are.
    """
    from numba.core import cgutils, types
    from numba.np.arrayobj import make_array, populate_array

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


@Intrinsic
def bits(typingctx: Any, number: Any) -> Any:
    """The eight bytes of a float as an int. Those of positive floats are in the order of the floats."""
    from numba.core import types

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.bitcast(args[0], context.get_value_type(types.int64))

    return types.int64(types.float64), codegen


@Intrinsic
def call_in_c(typingctx: Any, address: Any, given: Any, answer: Any) -> Any:
    """What a function int64 f(const double *, double *) of C's answers; it may be Python behind ctypes.

    Args:
        typingctx: numba's, not given by the caller.
        address: of its code.
        given: (n,) float64, read by it.
        answer: (m,) float64, filled by it.
    """
    from llvmlite import ir
    from numba.core import types
    from numba.np.arrayobj import make_array

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointers = [
            make_array(kind)(context, builder, array).data
            for kind, array in zip(signature.args[1:], args[1:], strict=True)
        ]
        kind = ir.FunctionType(ir.IntType(64), [pointer.type for pointer in pointers])
        return builder.call(builder.inttoptr(args[0], kind.as_pointer()), pointers)

    return types.int64(types.int64, given, answer), codegen


def prepare(function: CompiledFunction, *arguments: Any) -> None:
    """Have the code of a function for such arguments, from disk or made now."""
    function.form(*arguments)


def address_of(function: CompiledFunction, *arguments: Any, answers: Any = None) -> int:
    """Where the code of a compiled function lies for arguments of the types of these.

    Args:
        function: the function.
        arguments: of it.
        answers: what it answers: a numpy type, a tuple of them, or None for nothing.

    Raises:
        TypeError: it answers something else.
    """
    form = function.form(*arguments)
    told = answers if isinstance(answers, tuple) else (answers,)
    if form.answers != tuple("none" if kind is None else np.dtype(kind).name for kind in told):
        raise TypeError(f"{function.py_func.__qualname__} answers {', '.join(form.answers)}, not {answers}")
    return form.address


def on_disk(function: CompiledFunction) -> bool:
    """Whether machine code of a compiled function is kept on disk, made from what stands there now."""
    return function.on_disk


def compiled(function: Callable[..., Any]) -> CompiledFunction:
    """Compile `function` at its first call; the uncompiled one stays reachable as `.py_func`, the reference in tests.

    No fast-math: results are the same bits on every run, and equal to the reference's up to rounding.
    """
    return _compile(function)


def inlined(function: Callable[..., Any]) -> CompiledFunction:
    """The same for a function called from one place: compiled as a part of its caller, not once more by itself."""
    return _compile(function, inline="always")


def unlocked(function: Callable[..., Any]) -> CompiledFunction:
    """The same for a function that runs for long: other threads of Python go on while it does."""
    return _compile(function, nogil=True)


def _compile(function: Callable[..., Any], **options: Any) -> CompiledFunction:
    # Nothing calls these functions from C; a door for it would take a tenth of the time compiling takes.
    return CompiledFunction(function, dict(fastmath=False, error_model="numpy", no_cfunc_wrapper=True, **options))
