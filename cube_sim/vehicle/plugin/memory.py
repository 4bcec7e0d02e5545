"""Reading and writing MuJoCo's memory from compiled code: an address is an int64, everything else is an offset.

Nowhere else is a bare address trusted. `cube_sim.vehicle.plugin.structs` has checked every offset against live objects
before a model is stepped.

These functions are written for the code generator. As compiled functions each would be specialised by numba for every
literal index, a quarter of a second a time.
"""

from __future__ import annotations

import numba
import numpy as np
from llvmlite import ir
from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic

from cube_sim.vehicle.plugin import layout

_DOUBLE, _INT64 = ir.DoubleType(), ir.IntType(64)
_INT32 = ir.IntType(32)


@intrinsic
def _pointer(typingctx, address):
    def codegen(context, builder, signature, args):
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), codegen


@intrinsic
def double(typingctx, address, i):
    """Element i of an array of doubles."""

    def codegen(context, builder, signature, args):
        return builder.load(_element(builder, args, 8, _DOUBLE))

    return types.float64(types.int64, types.int64), codegen


@intrinsic
def columns_times(typingctx, address, x):
    """M x, a 6-tuple, of a 6-tuple and a matrix (6,6) that lies there column by column.

    Four elements and two are formed at once, in vectors, each from its first product to its sixth: the bits are those
    of `cube_sim.tuples.matrix_times_tuple`.
    """

    def codegen(context, builder, signature, args):
        parts = []
        for begin, size in ((0, 4), (4, 2)):
            kind = ir.VectorType(_DOUBLE, size)
            total = None
            for j in range(6):
                place = _element(builder, (args[0], ir.Constant(_INT64, 6 * j + begin)), 8, kind)
                column = builder.load(place, align=8)
                nothing, first = ir.Constant(kind, ir.Undefined), ir.Constant(_INT32, 0)
                factor = builder.insert_element(nothing, builder.extract_value(args[1], j), first)
                everywhere = ir.Constant(ir.VectorType(_INT32, size), [0] * size)
                product = builder.fmul(column, builder.shuffle_vector(factor, nothing, everywhere))
                total = product if total is None else builder.fadd(total, product)
            parts += [builder.extract_element(total, ir.Constant(_INT32, i)) for i in range(size)]
        return cgutils.pack_array(builder, parts)

    six = types.UniTuple(types.float64, 6)
    return six(types.int64, six), codegen


@intrinsic
def integer(typingctx, address, i):
    """Element i of an array of 32-bit integers."""

    def codegen(context, builder, signature, args):
        return builder.sext(builder.load(_element(builder, args, 4, _INT32)), _INT64)

    return types.int64(types.int64, types.int64), codegen


@intrinsic
def field(typingctx, address, offset):
    """A pointer or 64-bit size, `offset` bytes into a struct."""

    def codegen(context, builder, signature, args):
        return builder.load(_element(builder, args, 1, _INT64))

    return types.int64(types.int64, types.int64), codegen


@intrinsic
def put(typingctx, address, i, value):
    """Set element i of an array of doubles."""

    def codegen(context, builder, signature, args):
        builder.store(args[2], _element(builder, args[:2], 8, _DOUBLE))
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.float64), codegen


def _element(builder, args, size, kind):
    """Pointer to `kind` at address + size * index."""
    address, index = args
    return builder.inttoptr(builder.add(address, builder.mul(index, ir.Constant(_INT64, size))), kind.as_pointer())


@intrinsic
def force_table(typingctx):
    """Address of this process's table of user forces, known to the linker by name."""

    def codegen(context, builder, signature, args):
        module = builder.module
        name = layout.FORCE_TABLE
        table = module.globals.get(name) or ir.GlobalVariable(module, _INT64, name)
        return builder.ptrtoint(table, _INT64)

    return types.int64(), codegen


@intrinsic
def call_force(typingctx, function, time, position, rotation, nu, nu_r, seen):
    """Call the wrapper of a user's force at an address, see `cube_sim.vehicle.plugin.user_force_code`.

    Position and rotation are addresses, nu and nu_r 6-tuples. `seen` is a 7-tuple: the address of the commands and
    their number, of the activations and theirs, of the force's state and its number, and where its rates belong. It
    returns the wrench as a 6-tuple.
    """

    def codegen(context, builder, signature, args):
        address, time, position, rotation, nu, nu_r, seen = args
        pointer = _DOUBLE.as_pointer()
        rest = [pointer, _INT64, pointer, _INT64, pointer, _INT64, pointer]
        kind = ir.FunctionType(ir.VoidType(), [_DOUBLE, *[pointer] * 5, *rest])
        others = [builder.extract_value(seen, i) for i in range(len(rest))]
        others = [builder.inttoptr(x, t) if t is pointer else x for x, t in zip(others, rest, strict=True)]
        velocity = cgutils.alloca_once(builder, _DOUBLE, size=6)
        through_water = cgutils.alloca_once(builder, _DOUBLE, size=6)
        wrench = cgutils.alloca_once(builder, _DOUBLE, size=6)
        for i in range(6):
            builder.store(builder.extract_value(nu, i), cgutils.gep(builder, velocity, i))
            builder.store(builder.extract_value(nu_r, i), cgutils.gep(builder, through_water, i))
            builder.store(ir.Constant(_DOUBLE, 0.0), cgutils.gep(builder, wrench, i))
        builder.call(
            builder.inttoptr(address, kind.as_pointer()),
            [
                time,
                builder.inttoptr(position, pointer),
                builder.inttoptr(rotation, pointer),
                velocity,
                through_water,
                wrench,
                *others,
            ],
        )
        return cgutils.pack_array(builder, [builder.load(cgutils.gep(builder, wrench, i)) for i in range(6)])

    six = types.UniTuple(types.float64, 6)
    seven = types.UniTuple(types.int64, 7)
    return six(types.int64, types.float64, types.int64, types.int64, six, six, seven), codegen


@intrinsic
def room_for_hull(typingctx):
    """Address of room for one hull record, on the stack of the function that asks."""

    def codegen(context, builder, signature, args):
        return builder.ptrtoint(cgutils.alloca_once(builder, _DOUBLE, size=layout.HULL_SIZE), _INT64)

    return types.int64(), codegen


@intrinsic
def room_for_inertia(typingctx):
    """Address of room for a matrix (6,6), on the stack of the function that asks."""

    def codegen(context, builder, signature, args):
        return builder.ptrtoint(cgutils.alloca_once(builder, _DOUBLE, size=36), _INT64)

    return types.int64(), codegen


@numba.njit("float64[::1](int64, int64)")
def vector(address, n):
    """(n,) view of doubles."""
    return carray(_pointer(address), (n,), np.float64)


@numba.njit("float64[:,::1](int64, int64, int64)")
def matrix(address, rows, columns):
    """(rows, columns) view of doubles."""
    return carray(_pointer(address), (rows, columns), np.float64)
