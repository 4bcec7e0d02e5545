"""A function that machine code is made of when it is first called, or that is on disk already."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any

from cube_sim.native import doors
from cube_sim.native.doors import Door
from cube_sim.native.kinds import Kind, UnknownKindError, kinds_of, text_of
from cube_sim.native.stamps import file_stamp, stamp_of

MOST_LOOKED_AT = 3_000_000
"""So many words on arguments Python writes, a third of a microsecond each, before numba looks what they are: it does so
faster, but takes about as long as all of these until it does (a choice)."""

_making = threading.RLock()
"""While code is loaded or compiled; numba has one such lock itself, which is taken inside this one."""
_looked_at = [0]
_asking = threading.Lock()
"""While numba is told of a function, which whoever compiles others may wait for."""


class CompiledFunction:
    """A function and its machine code, a piece for each combination of kinds of arguments.

    Machine code on disk is called without numba. Whatever else is wanted of it, numba's dispatcher answers.

    Attributes:
        py_func: the function as it is written.
        targetoptions: how numba compiles it.
        forms: kinds of arguments that it has code for, in words.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        update_wrapper(self, function)
        self.py_func, self.targetoptions = function, options
        self.forms: dict[str, Door] = {}
        self._doors: dict[Kind, Door] = {}
        self._stamping = False
        self._dispatcher: Any = None
        self._call: Callable[..., Any] = self._through_a_door

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """What the function answers."""
        return self._call(*arguments, **named)

    def __repr__(self) -> str:
        """The same in every process."""
        return f"CompiledFunction({self._name})"

    def __reduce__(self) -> Any:
        """By its name, as a function is pickled and copied; made again where it has none."""
        named = getattr(sys.modules.get(self.py_func.__module__), self.py_func.__qualname__, None)
        return self.py_func.__qualname__ if named is self else (CompiledFunction, (self.py_func, self.targetoptions))

    def __getattr__(self, name: str) -> Any:
        """Whatever numba knows of it."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    @property
    def _numba_type_(self) -> Any:
        """For compiled functions that call this one."""
        return self.dispatcher._numba_type_

    @property
    def dispatcher(self) -> Any:
        """The same function as numba has it."""
        if self._dispatcher is None:
            from cube_sim.native.dispatching import dispatcher_of

            with _asking:
                self._dispatcher = self._dispatcher or dispatcher_of(self.py_func, self.targetoptions, self.stamp)
        return self._dispatcher

    def form(self, *arguments: Any) -> Door:
        """The machine code for such arguments, from disk or made now."""
        try:
            kind = kinds_of(arguments)
        except UnknownKindError:
            return self._compiled(arguments, None)
        return self._doors.get(kind) or self._open(kind, arguments)

    @property
    def on_disk(self) -> bool:
        """Whether machine code is kept on disk, made from what stands there now."""
        if self._lasts and doors.usual():  # to ask numba would load it
            return doors.on_disk(self._name, self.whole_stamp)
        file = getattr(getattr(self.dispatcher, "_cache", None), "_cache_file", None)
        return file is not None and bool(file._load_index())

    @cached_property
    def stamp(self) -> str:
        """Digest of what its code is made from besides its own file."""
        if self._stamping:
            return "itself"
        self._stamping = True
        try:
            told = stamp_of(self.py_func)
        finally:
            self._stamping = False
        # numba's own cache does not tell one from the other.
        return f"{told} checked" if self.targetoptions.get("boundscheck") else told

    @property
    def whole_stamp(self) -> str:
        """The same with its own file."""
        return f"{self._name} {file_stamp(self.py_func.__code__.co_filename)} {self.targetoptions} {self.stamp}"

    def _through_a_door(self, *arguments: Any, **named: Any) -> Any:
        if named:
            return self.dispatcher(*arguments, **named)
        try:
            kind = kinds_of(arguments)
        except UnknownKindError:
            return self.dispatcher(*arguments)
        _looked_at[0] += len(kind)
        if _looked_at[0] > MOST_LOOKED_AT:
            self._call = self.dispatcher
        door = self._doors.get(kind) or self._open(kind, arguments)
        return door.call(*arguments)

    def _open(self, kind: Kind, arguments: tuple[Any, ...]) -> Door:
        with _making:
            try:
                words = text_of(kind)
            except UnknownKindError:
                return self._compiled(arguments, None)
            door = self.forms.get(words)
            if door is None:
                kept = self._lasts and len(arguments) == self.py_func.__code__.co_argcount
                door = doors.load(self._name, words, self.whole_stamp) if kept else None
                door = door or self._compiled(arguments, words if kept else None)
                self.forms[words] = door
            self._doors[kind] = door
            return door

    def _compiled(self, arguments: tuple[Any, ...], words: str | None) -> Door:
        """By numba; kept on disk where there are words for its kind."""
        from cube_sim.native.dispatching import answers_of_call, code_of, compile_for

        with _making:
            overload = compile_for(self.dispatcher, arguments)
            code = None if words is None else code_of(self.dispatcher, overload)
            if words is not None and code is not None:
                doors.keep(self._name, words, self.whole_stamp, code)
            address = int(overload.library.get_pointer_to_function(overload.fndesc.llvm_func_name))
            return Door(self.dispatcher, address, answers_of_call(overload.signature))

    @property
    def _lasts(self) -> bool:
        """Whether another process finds the same function by its name."""
        return (
            self.py_func.__closure__ is None
            and "<locals>" not in self.py_func.__qualname__
            and (self.py_func.__module__ != "__main__")
        )

    @property
    def _name(self) -> str:
        return f"{self.py_func.__module__}.{self.py_func.__qualname__}"
