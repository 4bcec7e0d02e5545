"""A function that compiled code calls by its address: what it takes and what it answers, on both sides the same.

The caller's compiler sees an address only. Told the callee, it refuses other arguments: a matrix whose rows are apart
would be read as if they were not.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from cube_sim.native.compiled import address_of
from cube_sim.native.function import CompiledFunction
from cube_sim.native.intrinsics import Intrinsic

Examples = Callable[[], tuple[Any, ...]]
_known: dict[str, Callee] = {}
"""By the names of their types."""


class Callee:
    """What `call_at` is told of the function at an address.

    Args:
        function: the compiled function, or one of several that are called from the same place.
        examples: gives arguments of the types that its code is made for.
        answers: a numpy type, a tuple of them, or None for nothing.
    """

    def __init__(
        self, function: CompiledFunction, examples: Callable[[], tuple[Any, ...]], answers: Any = None
    ) -> None:
        self._function, self._examples, self._answers = function, examples, answers
        self._name = f"{function.py_func.__module__}.{function.py_func.__qualname__}"

    def __repr__(self) -> str:
        """What machine code of its callers depends on, beside the types that they give."""
        return f"Callee({self._name}, {self._answers})"

    @property
    def on_disk(self) -> bool:
        """Whether there is machine code of it."""
        return self._function.on_disk

    def address(self, function: CompiledFunction | None = None) -> int:
        """Where its code lies, made now where there is none.

        Args:
            function: another one that may be called in its place.
        """
        return address_of(function or self._function, *self._examples(), answers=self._answers)

    @cached_property
    def _numba_type_(self) -> Any:
        from numba.core import types

        _known[repr(self)] = self
        return types.Dummy(repr(self))

    def answer_to(self, kinds: tuple[Any, ...]) -> Any:
        """The type of its answer to arguments of numba's types.

        Raises:
            TypingError: it is compiled for others.
        """
        from numba import typeof
        from numba.core import types
        from numba.core.errors import TypingError
        from numba.np.numpy_support import from_dtype

        made_for = tuple(typeof(example) for example in self._examples())
        if kinds != made_for:
            pairs = zip(kinds, made_for, strict=False)
            which = next((f"argument {i + 1} is {a}, not {b}" for i, (a, b) in enumerate(pairs) if a != b), None)
            said = which or f"there are {len(kinds)} arguments, not {len(made_for)}"
            raise TypingError(f"{self._name} is called by its address with other arguments than it is for: {said}")
        if self._answers is None:
            return types.none
        if isinstance(self._answers, tuple):
            return types.Tuple([from_dtype(np.dtype(kind)) for kind in self._answers])
        return from_dtype(np.dtype(self._answers))


@Intrinsic
def call_at(typingctx: Any, callee: Any, address: Any, arguments: Any) -> Any:
    """What a compiled function answers, without its code in the caller's: large functions need not be compiled twice.

    Args:
        typingctx: numba's, not given by the caller.
        callee: `Callee` of the function, which need not be compiled by whoever calls it.
        address: of its code.
        arguments: a tuple, of the very types that it is compiled for: others are an error of the compiler's.
    """
    from numba.core import cgutils, types

    kinds = tuple(types.unliteral(kind) for kind in arguments)
    result = _known[callee.name].answer_to(kinds)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        convention = context.call_conv
        pointer = builder.inttoptr(args[1], convention.get_function_type(result, kinds).as_pointer())
        given = cgutils.unpack_tuple(builder, args[2])
        status, answer = convention.call_function(builder, pointer, result, kinds, given)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return answer

    return result(callee, types.int64, arguments), codegen
