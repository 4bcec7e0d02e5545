"""The water inside MuJoCo: two compiled callbacks, installed once per process.

`passive` replaces the inertia of every hull by M_RB + M_A and adds the remaining water forces to `qfrc_passive`, so
that MuJoCo itself solves for the acceleration: added mass is implicit, never lagged. `thrust` evaluates the thruster
characteristic on the lagged command. Both are C function pointers: threads run them freely, without the interpreter's
lock. They keep no state, find their parameters inside the model (`cube_sim.vehicle.packing`) and return at once for
models that are not ours, also while those are being compiled.
"""

from __future__ import annotations

import ctypes
import hashlib
from functools import cache
from pathlib import Path

import llvmlite.binding
import mujoco
import numba
import numpy as np
from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic

from cube_sim.errors import ModelError
from cube_sim.vehicle import characteristic, hydrodynamics, packing, structs
from cube_sim.vehicle.characteristic import force_of_command
from cube_sim.vehicle.hydrodynamics import water_wrench

_MAGIC, _HEADER = packing.MAGIC, packing.HEADER_SIZE
_COUNT, _HULLS, _ACTUATORS = packing.COUNT, packing.HULLS, packing.ACTUATORS
_BODY, _DOF, _DISPLACED, _CENTRE = packing.BODY, packing.DOF, packing.DISPLACED_MASS, packing.CENTRE
_ADDED, _LINEAR, _QUADRATIC, _SIZE = (
    packing.ADDED_MASS,
    packing.LINEAR,
    packing.QUADRATIC,
    packing.HULL_SIZE,
)
_LOW, _HIGH, _POINTS, _CURVE = packing.DEAD_LOW, packing.DEAD_HIGH, packing.POINTS, packing.CURVE

_factor_mass_matrix = types.ExternalFunction("mj_factorM", types.void(types.voidptr, types.voidptr))


@intrinsic
def _pointer(typingctx, address):
    """An int64 address as a void pointer."""

    def codegen(context, builder, signature, args):
        return builder.inttoptr(args[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), codegen


@numba.njit(cache=True)
def _doubles(address, start, size):
    """`size` doubles at `address`, from element `start` on."""
    return carray(_pointer(address + 8 * start), size, np.float64)


@numba.njit(cache=True)
def _integers(address, start, size):
    return carray(_pointer(address + 4 * start), size, np.int32)


@numba.njit(cache=True)
def _spatial_row(crb, cdof, i):
    """Composite inertia times motion axis i: MuJoCo's 10-vector inertia (I, m c, m) on an axis (w, v)."""
    w0, w1, w2 = cdof[i, 0], cdof[i, 1], cdof[i, 2]
    v0, v1, v2 = cdof[i, 3], cdof[i, 4], cdof[i, 5]
    return (
        crb[0] * w0 + crb[3] * w1 + crb[4] * w2 - crb[8] * v1 + crb[7] * v2,
        crb[3] * w0 + crb[1] * w1 + crb[5] * w2 + crb[8] * v0 - crb[6] * v2,
        crb[4] * w0 + crb[5] * w1 + crb[2] * w2 - crb[7] * v0 + crb[6] * v1,
        crb[8] * w1 - crb[7] * w2 + crb[9] * v0,
        crb[6] * w2 - crb[8] * w0 + crb[9] * v1,
        crb[7] * w0 - crb[6] * w1 + crb[9] * v2,
    )


@numba.njit(cache=True)
def _immerse(hull, gravity, wind, qvel, R, cdof, crb, armature, rowadr, M, force):
    """One hull: overwrite its rows of the mass matrix and add the water's force.

    The free joint's linear axes are the world's and its angular axes the body's, so with B = blkdiag(R', I) the
    generalised inertia is B'(M_RB + M_A)B. The rigid part is rebuilt from the composite inertia rather than read back:
    derivatives rerun this stage on a matrix that already holds M_A. Arms on the hull are in the composite.
    """
    M_A = hull[_ADDED:_LINEAR].reshape(6, 6)
    D = hull[_LINEAR:_QUADRATIC].reshape(6, 6)
    D_q = hull[_QUADRATIC:_SIZE].reshape(6, 6)
    for i in range(6):
        f = _spatial_row(crb, cdof, i)
        for j in range(i + 1):
            rigid = (
                cdof[j, 0] * f[0]
                + cdof[j, 1] * f[1]
                + cdof[j, 2] * f[2]
                + cdof[j, 3] * f[3]
                + cdof[j, 4] * f[4]
                + cdof[j, 5] * f[5]
            )
            M[rowadr[i] + j] = rigid + _added(M_A, R, i, j)
        M[rowadr[i] + i] += armature[i]
    v0 = R[0, 0] * qvel[0] + R[1, 0] * qvel[1] + R[2, 0] * qvel[2]
    v1 = R[0, 1] * qvel[0] + R[1, 1] * qvel[1] + R[2, 1] * qvel[2]
    v2 = R[0, 2] * qvel[0] + R[1, 2] * qvel[1] + R[2, 2] * qvel[2]
    nu = (v0, v1, v2, qvel[3], qvel[4], qvel[5])
    weight = -hull[_DISPLACED]
    buoyancy = (weight * gravity[0], weight * gravity[1], weight * gravity[2])
    r_CB = hull[_CENTRE:_ADDED]
    current = (wind[0], wind[1], wind[2])
    F = water_wrench(M_A, D, D_q, R, nu, current, buoyancy, (r_CB[0], r_CB[1], r_CB[2]))
    for i in range(3):
        force[i] += R[i, 0] * F[0] + R[i, 1] * F[1] + R[i, 2] * F[2]
        force[3 + i] += F[3 + i]


@numba.njit(cache=True)
def _added(M_A, R, i, j):
    """Entry (i, j), j <= i, of B' M_A B."""
    if i < 3:
        total = 0.0
        for a in range(3):
            for b in range(3):
                total += R[i, a] * M_A[a, b] * R[j, b]
        return total
    if j < 3:
        return M_A[i, 0] * R[j, 0] + M_A[i, 1] * R[j, 1] + M_A[i, 2] * R[j, 2]
    return M_A[i, j]


def _build(model_type: np.dtype, data_type: np.dtype, no_gravity: int, fingerprint: str):
    """Compile both callbacks for one memory layout.

    What the machine code depends on beyond its own source stands in closure variables, because the disk cache is
    keyed by those: the struct offsets, and a fingerprint of the laws compiled into it.
    """

    def passive(model, data):
        if len(fingerprint) == 0:
            return
        m = carray(model, 1, model_type)[0]
        address = m.numeric_data if m.nnumeric > 0 else 0
        if address == 0:
            return
        address += 8 * _integers(m.numeric_adr, m.nnumeric - 1, 1)[0]
        header = _doubles(address, 0, _HEADER)
        if header[0] != _MAGIC:
            return
        d = carray(data, 1, data_type)[0]
        weightless = m.opt_disableflags & no_gravity
        gravity = m.opt_gravity
        down = (0.0, 0.0, 0.0) if weightless else (gravity[0], gravity[1], gravity[2])
        for k in range(int(header[_COUNT])):
            hull = _doubles(address, int(header[_HULLS]) + k * _SIZE, _SIZE)
            body, dof = int(hull[_BODY]), int(hull[_DOF])
            rows = _integers(m.M_rowadr, dof, 6)
            _immerse(
                hull,
                down,
                m.opt_wind,
                _doubles(d.qvel, dof, 6),
                _doubles(d.xmat, 9 * body, 9).reshape(3, 3),
                _doubles(d.cdof, 6 * dof, 36).reshape(6, 6),
                _doubles(d.crb, 10 * body, 10),
                _doubles(m.dof_armature, dof, 6),
                rows,
                _doubles(d.M, 0, rows[5] + 6),
                _doubles(d.qfrc_passive, dof, 6),
            )
        _factor_mass_matrix(model, data)

    def thrust(model, data, actuator):
        if len(fingerprint) == 0:
            return 0.0
        m = carray(model, 1, model_type)[0]
        address = m.numeric_data if m.nnumeric > 0 else 0
        if address == 0:
            return 0.0
        address += 8 * _integers(m.numeric_adr, m.nnumeric - 1, 1)[0]
        header = _doubles(address, 0, _HEADER)
        if header[0] != _MAGIC:
            return 0.0
        start = int(_doubles(address, int(header[_ACTUATORS]) + actuator, 1)[0])
        if start < 0:
            return 0.0
        d = carray(data, 1, data_type)[0]
        curve = _doubles(address, start, _CURVE)
        n = int(curve[_POINTS])
        command = _doubles(d.act, _integers(m.actuator_actadr, actuator, 1)[0], 1)[0]
        return force_of_command(
            command,
            curve[_LOW],
            curve[_HIGH],
            _doubles(address, start + _CURVE, n),
            _doubles(address, start + _CURVE + n, n),
        )

    handles = types.voidptr, types.voidptr
    return (
        numba.cfunc(types.void(*handles), cache=True)(passive),
        numba.cfunc(types.double(*handles, types.int32), cache=True)(thrust),
    )


def _fingerprint() -> str:
    """Identifies the source of everything compiled into the callbacks; numba's cache only watches their own file."""
    digest = hashlib.sha256(numba.__version__.encode())
    for module in (characteristic, hydrodynamics, packing):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()


@cache
def _callbacks():
    library = next(Path(mujoco.__file__).parent.glob("libmujoco.so*"))
    llvmlite.binding.load_library_permanently(str(library))
    return _build(
        structs.record("mjModel", structs.MODEL_FIELDS),
        structs.record("mjData", structs.DATA_FIELDS),
        int(mujoco.mjtDisableBit.mjDSBL_GRAVITY),
        _fingerprint(),
    )


def install() -> None:
    """Hook the water into this process's MuJoCo; a second call changes nothing.

    Raises:
        ModelError: another passive or actuator-bias callback is installed; MuJoCo has room for one of each.
    """
    passive, thrust = _callbacks()
    for name, callback, setter, getter in (
        ("mjcb_passive", passive, mujoco.set_mjcb_passive, mujoco.get_mjcb_passive),
        ("mjcb_act_bias", thrust, mujoco.set_mjcb_act_bias, mujoco.get_mjcb_act_bias),
    ):
        present = getter()
        if present is not None and _address(present) != callback.address:
            raise ModelError(
                name, "is already taken by another callback; clear it (set it to None) before loading water"
            )
        setter(callback.ctypes)


def _address(callback) -> int | None:
    try:
        return ctypes.cast(callback, ctypes.c_void_p).value
    except (ctypes.ArgumentError, TypeError):
        return None
