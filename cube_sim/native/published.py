"""A number that one thread writes for another to read, while neither waits for the other."""

from __future__ import annotations

from typing import Any

from cube_sim.native.intrinsics import Intrinsic


@Intrinsic
def publish(typingctx: Any, numbers: Any, at: Any, value: Any) -> Any:
    """Write one of the numbers, after all that was written before it: whoever reads it sees that too.

    Args:
        typingctx: numba's, not given by the caller.
        numbers: (n,) int64.
        at: which of them.
        value: what it becomes.
    """
    from numba.core import types
    from numba.np.arrayobj import make_array

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        place = builder.gep(make_array(signature.args[0])(context, builder, args[0]).data, [args[1]])
        builder.store_atomic(args[2], place, "release", 8)
        return context.get_dummy_value()

    return types.void(numbers, types.intp, types.int64), codegen


@Intrinsic
def published(typingctx: Any, numbers: Any, at: Any) -> Any:
    """One of the numbers as it is now, read before all that is read after it.

    Args:
        typingctx: numba's, not given by the caller.
        numbers: (n,) int64.
        at: which of them.
    """
    from numba.core import types
    from numba.np.arrayobj import make_array

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        place = builder.gep(make_array(signature.args[0])(context, builder, args[0]).data, [args[1]])
        return builder.load_atomic(place, "acquire", 8)

    return types.int64(numbers, types.intp), codegen
