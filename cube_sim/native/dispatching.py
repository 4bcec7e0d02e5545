"""numba's part of a compiled function: what compiles it, and numba's own cache, which compiled callers take it from.

Only imported where something is compiled.
"""

from __future__ import annotations

import pickle
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numba
from numba.core import types

from cube_sim.native.called import CalledCache, CalledCompiler
from cube_sim.native.doors import MachineCode, answers_of, outside_of
from cube_sim.native.lent import LendingCompiler
from cube_sim.native.object_cache import numba_folder

_settings = threading.Lock()


def dispatcher_of(function: Callable[..., Any], options: dict[str, Any], stamp: str) -> Any:
    """numba's dispatcher of a function, which compiles it anew when the stamp is another one.

    What compiled code calls is compiled for it apart, see `cube_sim.native.called`; `.called()` is what numba knows of
    that.

    Args:
        function: to be compiled.
        options: how.
        stamp: what it is made from besides its own file, which numba looks at itself.
    """
    try:
        with _kept():
            dispatcher = numba.njit(cache=True, pipeline_class=LendingCompiler, **options)(function)
    except RuntimeError:  # no file, and so no place beside it
        dispatcher = numba.njit(pipeline_class=LendingCompiler, **options)(function)
    file = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if file is not None:  # numba has no public way to say what a cached function depends on
        _depend_on(file, stamp)

    @cache
    def called() -> Any:  # only where something is compiled that calls it
        inner = numba.njit(no_cpython_wrapper=True, pipeline_class=CalledCompiler, **options)(function)
        if file is not None:
            with _kept():
                inner._cache = CalledCache(function)
            _depend_on(inner._cache._cache_file, stamp)
        return inner

    # numba has no public way to ask for these either.
    dispatcher.called = called
    dispatcher.get_call_template = _once_for_all_numbers(lambda args, kws: called().get_call_template(args, kws))
    dispatcher.get_overload = lambda signature: called().get_overload(signature)
    return dispatcher


@contextmanager
def _kept() -> Iterator[None]:
    """While a function is given its place on disk: numba looks for that in its settings, which are everybody's."""
    with _settings:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = numba_folder() or before
        try:
            yield
        finally:
            numba.config.CACHE_DIR = before


def compile_for(dispatcher: Any, arguments: tuple[Any, ...]) -> Any:
    """Compile a function for arguments of the types of these; what numba knows of the result."""
    kinds = tuple(numba.typeof(argument) for argument in arguments)
    dispatcher.compile(kinds)
    return dispatcher.overloads[kinds]


def answers_of_call(signature: Any) -> tuple[str, ...]:
    """Types of what a call of such a signature answers, one by one."""
    answer = signature.return_type
    return answers_of(list(answer) if isinstance(answer, types.BaseTuple) else [answer])


def code_of(dispatcher: Any, overload: Any) -> MachineCode | None:
    """The machine code of what is compiled, as numba's own cache has it; None where that has none.

    numba keeps it nowhere else.
    """
    kept = dispatcher._cache
    try:
        key = kept._index_key(tuple(overload.signature.args), dispatcher.targetctx.codegen())
        found = kept._cache_file.load(key)
    except (AttributeError, OSError):
        return None
    if found is None:
        return None
    (_, form, content), fndesc, environment, signature, _, _, _, reload_init, others = found
    if form != "object" or reload_init:
        return None
    machine_code, llvm_code = content
    environments = [environment, *(each for each in others if each.env_name != fndesc.env_name)]
    return MachineCode(
        machine_code=machine_code,
        entry=fndesc.llvm_func_name,
        door=fndesc.llvm_cpython_wrapper_name,
        answers=answers_of_call(signature),
        environments=tuple(
            (name, list(each.consts))
            for name, each in zip([fndesc.env_name, *(e.env_name for e in environments[1:])], environments, strict=True)
        ),
        outside=outside_of(llvm_code),
    )


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
    """Read code from a cache, what is damaged like what is not there: numba makes it again then.

    Code holds the name of its function's module. A file of the user's goes by one name as a program, and by another
    where a scenario names it: the module is then not to be found.
    """

    def load_or_miss(name: str) -> Any:
        try:
            return load(name)
        except (AttributeError, ImportError, EOFError, ValueError, pickle.UnpicklingError) as error:
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
