"""Compiled code of the user's own, called by its address: it may fail, and whoever asks goes on."""

from __future__ import annotations

from typing import Any

import numpy as np

from cube_sim.native.intrinsics import Intrinsic

WORD = np.dtype([("word", np.float64)])
"""Any record of whole words, for a caller that knows nothing of its fields: compiled code hands on where it lies."""


@Intrinsic
def ask_at(typingctx: Any, example: Any, address: Any, arguments: Any) -> Any:
    """Whether a compiled function has an answer, and which; it has none where it raises, and zeros stand for it.

    Args:
        typingctx: numba's, not given by the caller.
        example: of an answer, for its type.
        address: of its code, for arguments of these types but for the fields of records among them.
        arguments: a tuple.
    """
    from numba.core import types

    kinds = tuple(types.unliteral(kind) for kind in arguments)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        from numba.core import cgutils

        convention = context.call_conv
        pointer = builder.inttoptr(args[1], convention.get_function_type(example, kinds).as_pointer())
        given = cgutils.unpack_tuple(builder, args[2])
        status, answer = convention.call_function(builder, pointer, example, kinds, given)
        return context.make_tuple(builder, signature.return_type, [status.is_ok, answer])

    return types.Tuple([types.boolean, example])(example, types.int64, arguments), codegen
