"""One way to compile a hot law: numba, cached on disk, with the plain function kept as `.py_func`.

Machine code on disk is used again until something changes that it was made from. numba's own stamp knows the file a
function is written in only. Here it covers also

- the functions it calls from other files, to any depth;
- the constants and the fields of named tuples it takes from outside;
- the files of the intrinsics it uses;
- this file, `cube_sim.native.called` and `cube_sim.native.lent`, which say how it is compiled.

Functions must therefore be defined before those that call them.
"""

from __future__ import annotations

import hashlib
import inspect
import pickle
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.extending import _Intrinsic
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from cube_sim.native.called import CalledCache, CalledCompiler
from cube_sim.native.lent import LendingCompiler


@intrinsic
def borrowed(typingctx: Any, array: Any) -> Any:
    """The same array without a share in its memory: views of it cost no reference counting, nor does handing them on.

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
    """Entries of a flat array as an array of another shape, without a share in its memory.

    Nothing is checked. Whoever holds the flat array must hold it as long as the piece is used.

    Args:
        typingctx: numba's, not given by the caller.
        array: (n,) float64.
        at: index of the first entry.
        shape: of the result, a tuple of int.
        dtype: np.float64 or np.int64, whose eight bytes are read as they are.
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
    """The eight bytes of a float as an int. Those of positive floats are in the order of the floats."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.bitcast(args[0], context.get_value_type(types.int64))

    return types.int64(types.float64), codegen


@intrinsic
def call_at(typingctx: Any, function: Any, address: Any, arguments: Any) -> Any:
    """What a compiled function answers, without its code in the caller's: large functions need not be compiled twice.

    Args:
        typingctx: numba's, not given by the caller.
        function: that is called; or the type it answers, a tuple of types, or None for nothing: then it need not be
            compiled by whoever calls it.
        address: of its code, `address_of` arguments of these types.
        arguments: a tuple.
    """
    kinds = tuple(types.unliteral(kind) for kind in arguments)
    if isinstance(function, types.NumberClass):
        result = function.instance_type
    elif isinstance(function, types.BaseTuple):
        result = types.Tuple([kind.instance_type for kind in function])
    elif function is types.none:
        result = types.none
    else:
        result = function.get_call_type(typingctx, kinds, {}).return_type

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        convention = context.call_conv
        pointer = builder.inttoptr(args[1], convention.get_function_type(result, kinds).as_pointer())
        given = cgutils.unpack_tuple(builder, args[2])
        status, answer = convention.call_function(builder, pointer, result, kinds, given)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return answer

    return result(function, types.int64, arguments), codegen


@intrinsic
def call_in_c(typingctx: Any, address: Any, given: Any, answer: Any) -> Any:
    """What a function int64 f(const double *, double *) of C's answers; it may be Python behind ctypes.

    Args:
        typingctx: numba's, not given by the caller.
        address: of its code.
        given: (n,) float64, read by it.
        answer: (m,) float64, filled by it.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        pointers = [
            make_array(kind)(context, builder, array).data
            for kind, array in zip(signature.args[1:], args[1:], strict=True)
        ]
        kind = ir.FunctionType(ir.IntType(64), [pointer.type for pointer in pointers])
        return builder.call(builder.inttoptr(args[0], kind.as_pointer()), pointers)

    return types.int64(types.int64, given, answer), codegen


def compile_for(function: Any, *arguments: Any) -> Any:
    """Compile a function for arguments of the types of these; what numba knows of the result."""
    kinds = tuple(numba.typeof(argument) for argument in arguments)
    function.compile(kinds)
    return function.overloads[kinds]


def address_of(function: Any, *arguments: Any, answers: Any = None) -> int:
    """Where the code of a compiled function lies for arguments of the types of these.

    Args:
        function: the function.
        arguments: of it.
        answers: what it answers, as `call_at` is told: a numpy type, a tuple of them, or None for nothing.

    Raises:
        TypeError: it answers something else.
    """
    overload = compile_for(function, *arguments)
    told = answers if isinstance(answers, tuple) else (answers,)
    said = overload.signature.return_type
    if (list(said) if isinstance(said, types.BaseTuple) else [said]) != [_kind(each) for each in told]:
        raise TypeError(f"{function.py_func.__qualname__} answers {said}, not {answers}")
    return int(overload.library.get_pointer_to_function(overload.fndesc.llvm_func_name))


def _kind(kind: Any) -> Any:
    return types.none if kind is None else numba.from_dtype(np.dtype(kind))


def on_disk(function: Any) -> bool:
    """Whether machine code of a compiled function is kept on disk, made from what stands there now."""
    file = getattr(getattr(function, "_cache", None), "_cache_file", None)
    return file is not None and bool(file._load_index())


def compiled(function: Callable[..., Any]) -> Any:
    """Compile `function` at its first call; the uncompiled one stays reachable as `.py_func`, the reference in tests.

    What compiled code calls is compiled for it apart, see `cube_sim.native.called`; `.called()` is what numba knows of
    that.

    No fast-math: results are the same bits on every run, and equal to the reference's up to rounding.
    """
    return _compile(function)


def inlined(function: Callable[..., Any]) -> Any:
    """The same for a function called from one place: compiled as a part of its caller, not once more by itself."""
    return _compile(function, inline="always")


def unlocked(function: Callable[..., Any]) -> Any:
    """The same for a function that runs for long: other threads of Python go on while it does."""
    return _compile(function, nogil=True)


def _compile(function: Callable[..., Any], **options: Any) -> Any:
    # Nothing calls these functions from C; a door for it would take a tenth of the time compiling takes.
    way: dict[str, Any] = dict(fastmath=False, error_model="numpy", no_cfunc_wrapper=True, **options)
    dispatcher = numba.njit(cache=True, pipeline_class=LendingCompiler, **way)(function)
    file, stamp = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None), ""
    if file is not None:  # numba has no public way to say what a cached function depends on
        stamp = _stamp(function)
        _depend_on(file, stamp)

    @cache
    def called() -> Any:  # only where something is compiled that calls it
        inner = numba.njit(no_cpython_wrapper=True, pipeline_class=CalledCompiler, **way)(function)
        if file is not None:
            inner._cache = CalledCache(function)
            _depend_on(inner._cache._cache_file, stamp)
        return inner

    # numba has no public way to ask for these either.
    dispatcher.called = called
    dispatcher.get_call_template = _once_for_all_numbers(lambda args, kws: called().get_call_template(args, kws))
    dispatcher.get_overload = lambda signature: called().get_overload(signature)
    return dispatcher


def _depend_on(file: Any, stamp: str) -> None:
    """Let code on disk count only where this stamp is the one it was made with."""
    file._source_stamp = (file._source_stamp, stamp)
    file._load_index = _forgiving(file._load_index)
    file._load_data = _as_if_missing(file._load_data)


def _once_for_all_numbers(template: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function once for an integer, whether its callers give a variable or a constant.

    numba takes each constant for a type of its own, and a variable that starts at one likewise until it knows what
    follows. The same code would be compiled once for each of them.
    """

    def template_of(args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
        by_place = tuple(types.unliteral(given) for given in args)
        return template(by_place, {name: types.unliteral(given) for name, given in kws.items()})

    return template_of


def _as_if_missing(load: Callable[[str], Any]) -> Callable[[str], Any]:
    """Read code from a cache, what is damaged like what is not there: numba makes it again then."""

    def load_or_miss(name: str) -> Any:
        try:
            return load(name)
        except (EOFError, ValueError, pickle.UnpicklingError) as error:
            raise FileNotFoundError(name) from error

    return load_or_miss


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


def _stamp(function: Callable[..., Any]) -> str:
    """Digest of what a function's machine code is made from besides its own file, as this module says."""
    told: list[tuple[str, Any]] = [("how", _how())]
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


@cache
def _how() -> tuple[bytes, ...]:
    return tuple(
        Path(file).read_bytes()
        for file in (__file__, inspect.getfile(CalledCompiler), inspect.getfile(LendingCompiler))
    )


def _names(code: CodeType) -> set[str]:
    """Global names a function's code uses, those of functions inside it too."""
    inside = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*(_names(inner) for inner in inside))
