"""The memory layout of mjModel and mjData, as offsets that compiled code can read.

The layout is taken from the running MuJoCo's own description of its C structs, and checked against the live objects.
So a new MuJoCo release changes numbers, not this code.
"""

from __future__ import annotations

import ctypes
from functools import cache

import mujoco
import numpy as np
from mujoco.introspect import ast_nodes, structs

from cube_sim.errors import ModelError

MODEL_FIELDS = (
    "nv", "nnumeric", "opt.gravity", "opt.wind", "opt.disableflags", "opt.density", "opt.viscosity",
    "opt.solver", "opt.noslip_iterations", "opt.timestep", "numeric_adr", "numeric_data",
    "dof_armature", "M_rowadr", "actuator_actadr", "actuator_actnum",
    "actuator_ctrlrange", "actuator_dynprm", "actuator_trnid", "site_size",
    "body_rootid", "dof_bodyid", "dof_parentid", "M_rownnz",
)  # fmt: skip
DATA_FIELDS = (
    "time", "qvel", "xpos", "xmat", "site_xpos", "act", "act_dot", "userdata", "ctrl", "cdof", "crb", "M", "qLD",
    "qLDiagInv", "qfrc_passive", "cvel", "cdof_dot", "subtree_com",
)  # fmt: skip

_SCALARS = {
    "mjtSize": ctypes.c_int64, "mjtNum": ctypes.c_double, "mjtByte": ctypes.c_ubyte, "mjtBool": ctypes.c_bool,
    "int": ctypes.c_int, "float": ctypes.c_float, "size_t": ctypes.c_size_t, "uint64_t": ctypes.c_uint64,
    "uintptr_t": ctypes.c_size_t,
}  # fmt: skip


@cache
def offsets(struct: str, fields: tuple[str, ...]) -> dict[str, int]:
    """Byte offset of each field; arguments as in `record`, keys as in `fields`."""
    layout = record(struct, fields)
    return {path: int(layout.fields[path.replace(".", "_")][1]) for path in fields}  # type: ignore[index]


@cache
def record(struct: str, fields: tuple[str, ...]) -> np.dtype:
    """The named fields of a MuJoCo struct at their byte offsets; pointers appear as int64 addresses.

    Args:
        struct: "mjModel" or "mjData".
        fields: field names; "opt.wind" reaches into an embedded struct and becomes "opt_wind".
    """
    layout = _layout(struct)
    names, formats, offsets = [], [], []
    for path in fields:
        kind, offset = layout, 0
        for part in path.split("."):
            offset += getattr(kind, part).offset
            kind = dict(kind._fields_)[part]  # type: ignore[attr-defined]
        names.append(path.replace(".", "_"))
        formats.append(np.int64 if kind is ctypes.c_void_p else np.dtype(kind))  # type: ignore[call-overload]
        offsets.append(offset)
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ctypes.sizeof(layout)})


def number(data: mujoco.MjData, field: str) -> np.ndarray:
    """A view (1,) of a number in mjData, to be read as long as the data live."""
    place = ctypes.c_double.from_address(data._address + offsets("mjData", (field,))[field])
    return np.ctypeslib.as_array(ctypes.pointer(place), (1,))


def verify(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Check the layout against live objects: every pointer equals the address of the array Python sees.

    Raises:
        ModelError: this MuJoCo's structs differ from its own description; no force may be computed on such a guess.
    """
    for owner, name, fields in ((model, "mjModel", MODEL_FIELDS), (data, "mjData", DATA_FIELDS)):
        layout = record(name, fields)
        view = np.frombuffer(ctypes.string_at(owner._address, layout.itemsize), layout)[0]
        for field in layout.names or ():
            if field.startswith("opt_"):
                expected = getattr(model.opt, field[4:])
                agrees = np.array_equal(view[field], expected, equal_nan=True)
            else:
                value = getattr(owner, field)
                if isinstance(value, np.ndarray):
                    agrees = value.size == 0 or int(view[field]) == value.ctypes.data
                else:
                    agrees = int(view[field]) == int(value)
            if not agrees:
                raise ModelError(f"{name}.{field}", f"lies elsewhere in MuJoCo {mujoco.__version__} than it describes")


@cache
def _layout(name: str) -> type[ctypes.Structure]:
    declared = structs.STRUCTS[name]
    return _structure(name, declared.fields)


def _structure(name: str, fields) -> type[ctypes.Structure]:
    members = []
    for i, field in enumerate(fields):
        label = getattr(field, "name", f"anonymous_{i}")
        members.append((label, _ctype(f"{name}.{label}", getattr(field, "type", field))))
    return type(name, (ctypes.Structure,), {"_fields_": members})


def _ctype(path: str, kind):
    if isinstance(kind, ast_nodes.PointerType):
        return ctypes.c_void_p
    if isinstance(kind, ast_nodes.ArrayType):
        inner = _ctype(path, kind.inner_type)
        for extent in reversed(kind.extents):
            inner = inner * extent
        return inner
    if isinstance(kind, ast_nodes.AnonymousStructDecl):
        return _structure(path, kind.fields)
    if kind.name in _SCALARS:
        return _SCALARS[kind.name]
    if kind.name in structs.STRUCTS:
        return _layout(kind.name)
    return ctypes.c_int  # enums
