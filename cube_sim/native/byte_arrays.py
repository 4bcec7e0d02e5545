"""Bytes written by compiled code, many at a time. Nothing is checked."""

from __future__ import annotations

from typing import Any

from cube_sim.native.intrinsics import Intrinsic


@Intrinsic
def copy_bytes(typingctx: Any, out: Any, at: Any, source: Any, start: Any, count: Any) -> Any:
    """Copy bytes from one array to another.

    Args:
        typingctx: numba's, not given by the caller.
        out: bytes, filled.
        at: where in it.
        source: bytes of another array.
        start: where in it.
        count: how many.
    """
    from numba.core import cgutils, types
    from numba.np.arrayobj import make_array

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        into = builder.gep(make_array(signature.args[0])(context, builder, args[0]).data, [args[1]])
        given = builder.gep(make_array(signature.args[2])(context, builder, args[2]).data, [args[3]])
        cgutils.raw_memcpy(builder, into, given, args[4], 1)
        return context.get_dummy_value()

    return types.void(out, types.intp, source, types.intp, types.intp), codegen


@Intrinsic
def put_integer(typingctx: Any, out: Any, at: Any, value: Any) -> Any:
    """Write an integer as its bytes, as many as its type has, in the machine's order.

    Args:
        typingctx: numba's, not given by the caller.
        out: bytes, filled.
        at: where in it.
        value: the integer.
    """
    from numba.core import types
    from numba.np.arrayobj import make_array

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        place = builder.gep(make_array(signature.args[0])(context, builder, args[0]).data, [args[1]])
        builder.store(args[2], builder.bitcast(place, args[2].type.as_pointer()), align=1)
        return context.get_dummy_value()

    return types.void(out, types.intp, value), codegen
