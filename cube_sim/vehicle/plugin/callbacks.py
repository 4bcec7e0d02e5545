"""The two callbacks MuJoCo runs, as Python that numba compiles.

`passive` replaces the inertia of every hull by M_RB + M_A and adds the remaining water forces to `qfrc_passive`. MuJoCo
itself then solves for the acceleration: added mass is implicit, never lagged. `thrust` evaluates the thruster
characteristic on the lagged command.

They keep no state and find their parameters inside the model (`cube_sim.vehicle.plugin.layout`). For a model that is
not ours they return at once, also while it is being compiled.
"""

from __future__ import annotations

from collections.abc import Mapping

import numba
from numba import types

from cube_sim.vehicle.laws.current import accelerating_water, current_at
from cube_sim.vehicle.laws.hydrodynamics import relative_velocity, water_wrench
from cube_sim.vehicle.laws.thrust_law import force_of_command
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.memory import call_force, double, field, force_table, integer, matrix, put, vector

_factor_mass_matrix = types.ExternalFunction("mj_factorM", types.void(types.int64, types.int64))
_project_constraints = types.ExternalFunction("mj_projectConstraint", types.void(types.int64, types.int64))


@numba.njit
def _spatial_row(crb, cdof, i):
    """Composite inertia times motion axis i, a 6-tuple: MuJoCo's 10-vector inertia (I, m c, m) on an axis (w, v).

    Args:
        crb: (10,) I_xx, I_yy, I_zz, I_xy, I_xz, I_yz [kg m^2], m c [kg m], m [kg].
        cdof: (6,6) motion axes (w, v) of the free joint.
        i: which of them.
    """
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


@numba.njit
def _put_inertia(M_A, R, cdof, crb, armature, rowadr, M):
    """Overwrite one hull's rows of the mass matrix by B'(M_RB + M_A)B, B = blkdiag(R', I).

    The free joint's linear axes are the world's, its angular axes the body's. The rigid part is computed again from the
    composite inertia: derivatives rerun this stage on a matrix that already holds M_A. Arms on the hull are in the
    composite.

    Args:
        M_A: added mass (6,6), body axes.
        R: R_WB (3,3).
        cdof: (6,6) and `crb` (10,) as in `_spatial_row`.
        crb: the composite inertia.
        armature: address of the joint's six armatures.
        rowadr: address of the six starts of its rows in `M`.
        M: address of MuJoCo's sparse mass matrix, whose rows hold the columns up to the diagonal.
    """
    for i in range(3):
        # R M11 R' + m I, one row at a time
        t0 = R[i, 0] * M_A[0, 0] + R[i, 1] * M_A[1, 0] + R[i, 2] * M_A[2, 0]
        t1 = R[i, 0] * M_A[0, 1] + R[i, 1] * M_A[1, 1] + R[i, 2] * M_A[2, 1]
        t2 = R[i, 0] * M_A[0, 2] + R[i, 1] * M_A[1, 2] + R[i, 2] * M_A[2, 2]
        start = integer(rowadr, i)
        for j in range(i + 1):
            put(M, start + j, t0 * R[j, 0] + t1 * R[j, 1] + t2 * R[j, 2])
        put(M, start + i, double(M, start + i) + crb[9] + double(armature, i))
    for i in range(3, 6):
        f = _spatial_row(crb, cdof, i)
        start = integer(rowadr, i)
        for j in range(3):
            # a unit velocity along world axis j picks component j of the momentum: no product needed
            put(M, start + j, f[3 + j] + M_A[i, 0] * R[j, 0] + M_A[i, 1] * R[j, 1] + M_A[i, 2] * R[j, 2])
        for j in range(3, i + 1):
            rigid = (
                cdof[j, 0] * f[0]
                + cdof[j, 1] * f[1]
                + cdof[j, 2] * f[2]
                + cdof[j, 3] * f[3]
                + cdof[j, 4] * f[4]
                + cdof[j, 5] * f[5]
            )
            put(M, start + j, rigid + M_A[i, j])
        put(M, start + i, double(M, start + i) + double(armature, i))


@numba.njit
def _plus(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@numba.njit
def _not_a_number():
    """The wrench of what cannot be computed: MuJoCo warns of it at the first step, on any thread."""
    nan = float("nan")
    return (nan, nan, nan, nan, nan, nan)


@numba.njit
def _user_wrench(function, process, time, position, rotation, nu, nu_r):
    """The wrench of the hull's own force, a 6-tuple.

    It is not a number for a model from another process, whose functions are not here.
    """
    table = force_table()
    if double(table, 0) != process:
        return _not_a_number()
    return call_force(field(table, 8 * (function + 1)), time, position, rotation, nu, nu_r)


def build(model: Mapping[str, int], data: Mapping[str, int], codes: Mapping[str, int]) -> dict:
    """Compile both callbacks for one memory layout.

    Args:
        model: byte offsets of the fields of mjModel.
        data: byte offsets of the fields of mjData.
        codes: MuJoCo's numbers for "no_gravity", the disable flag that switches gravity off and buoyancy with it;
            "no_passive", the two that together skip `passive`; and "pgs", the solver.

    Returns:
        numba cfuncs "passive" (model, data) and "thrust" (model, data, actuator).
    """
    nnumeric, numeric_adr, numeric_data = model["nnumeric"], model["numeric_adr"], model["numeric_data"]
    opt_gravity, opt_wind, opt_disableflags = model["opt.gravity"], model["opt.wind"], model["opt.disableflags"]
    opt_density, opt_viscosity, opt_timestep = model["opt.density"], model["opt.viscosity"], model["opt.timestep"]
    opt_solver, opt_noslip = model["opt.solver"], model["opt.noslip_iterations"]
    no_gravity, no_passive, pgs = codes["no_gravity"], codes["no_passive"], codes["pgs"]
    dof_armature, m_rowadr, actuator_actadr = model["dof_armature"], model["M_rowadr"], model["actuator_actadr"]
    actuator_actnum = model["actuator_actnum"]
    time_, qvel, xpos, xmat, act = data["time"], data["qvel"], data["xpos"], data["xmat"], data["act"]
    cdof, crb, mass, qfrc_passive = data["cdof"], data["crb"], data["M"], data["qfrc_passive"]

    @numba.njit
    def parameters_of(m):
        """Address of the packed parameters, 0 for a model without water."""
        last = field(m, nnumeric) - 1
        if last < 0:
            return 0
        address = field(m, numeric_data)
        if address == 0:
            return 0
        address += 8 * integer(field(m, numeric_adr), last)
        if double(address, 0) != layout.MAGIC:
            return 0
        return address

    def passive(m, d):
        packed = parameters_of(m)
        if packed == 0:
            return
        down = (double(m + opt_gravity, 0), double(m + opt_gravity, 1), double(m + opt_gravity, 2))
        if integer(m + opt_disableflags, 0) & no_gravity:
            down = (0.0, 0.0, 0.0)
        steady = (double(m + opt_wind, 0), double(m + opt_wind, 1), double(m + opt_wind, 2))
        time = double(d + time_, 0)
        profile = int(double(packed, layout.CURRENT))
        for k in range(int(double(packed, layout.COUNT))):
            hull = packed + 8 * (int(double(packed, layout.HULLS)) + k * layout.HULL_SIZE)
            body, dof = int(double(hull, layout.BODY)), int(double(hull, layout.DOF))
            M_A = matrix(hull + 8 * layout.ADDED_MASS, 6, 6)
            position, rotation = field(d, xpos) + 24 * body, field(d, xmat) + 72 * body
            R = matrix(rotation, 3, 3)
            _put_inertia(
                M_A,
                R,
                matrix(field(d, cdof) + 48 * dof, 6, 6),
                vector(field(d, crb) + 80 * body, 10),
                field(m, dof_armature) + 8 * dof,
                field(m, m_rowadr) + 4 * dof,
                field(d, mass),
            )
            v = field(d, qvel) + 8 * dof
            vx, vy, vz = double(v, 0), double(v, 1), double(v, 2)
            nu = (
                R[0, 0] * vx + R[1, 0] * vy + R[2, 0] * vz,
                R[0, 1] * vx + R[1, 1] * vy + R[2, 1] * vz,
                R[0, 2] * vx + R[1, 2] * vy + R[2, 2] * vz,
                double(v, 3),
                double(v, 4),
                double(v, 5),
            )
            displaced = double(hull, layout.DISPLACED_MASS)
            r_CB = (double(hull, layout.CENTRE), double(hull, layout.CENTRE + 1), double(hull, layout.CENTRE + 2))
            current, surge = steady, (0.0, 0.0, 0.0)
            if profile >= 0:
                table = packed + 8 * profile
                n_t, n_z = int(double(table, 0)), int(double(table, 1))
                current, surge = current_at(
                    time,
                    double(position, 2),
                    vector(table + 16, n_t),
                    vector(table + 16 + 8 * n_t, n_z),
                    matrix(table + 16 + 8 * (n_t + n_z), n_t * n_z, 3),
                    steady,
                    double(m + opt_timestep, 0),
                )
            F = water_wrench(
                M_A,
                matrix(hull + 8 * layout.LINEAR, 6, 6),
                matrix(hull + 8 * layout.QUADRATIC, 6, 6),
                R,
                nu,
                current,
                (-displaced * down[0], -displaced * down[1], -displaced * down[2]),
                r_CB,
            )
            if profile >= 0:
                F = _plus(F, accelerating_water(M_A, displaced, r_CB, R, surge))
            function = int(double(hull, layout.FORCE))
            if function >= 0:
                nu_r = relative_velocity(R, nu, current)
                F = _plus(F, _user_wrench(function, double(packed, layout.PROCESS), time, position, rotation, nu, nu_r))
            if double(m + opt_density, 0) != 0.0 or double(m + opt_viscosity, 0) != 0.0:
                F = _not_a_number()  # MuJoCo's own fluid model was switched on later: every force twice
            force = field(d, qfrc_passive) + 8 * dof
            for i in range(3):
                put(force, i, double(force, i) + R[i, 0] * F[0] + R[i, 1] * F[1] + R[i, 2] * F[2])
                put(force, 3 + i, double(force, 3 + i) + F[3 + i])
        _factor_mass_matrix(m, d)
        if integer(m + opt_solver, 0) == pgs or integer(m + opt_noslip, 0) > 0:
            # These work on J M^-1 J', which MuJoCo has computed before the added mass was in M.
            _project_constraints(m, d)

    def thrust(m, d, actuator):
        packed = parameters_of(m)
        if packed == 0:
            return 0.0
        start = int(double(packed, int(double(packed, layout.THRUSTERS)) + actuator))
        if start < 0:
            return 0.0
        if integer(m + opt_disableflags, 0) & no_passive == no_passive:
            return float("nan")  # MuJoCo skips `passive`: the hull would be dry without a word
        curve = packed + 8 * start
        stuck = double(curve, layout.STUCK)
        if stuck == stuck:  # a number: the thruster holds that force whatever the command
            return stuck * double(curve, layout.SUPPLY)
        n = int(double(curve, layout.POINTS))
        adr = integer(field(m, actuator_actadr), actuator) + integer(field(m, actuator_actnum), actuator) - 1
        force = force_of_command(
            double(field(d, act), adr),
            double(curve, layout.DEAD_LOW),
            double(curve, layout.DEAD_HIGH),
            vector(curve + 8 * layout.CURVE, n),
            vector(curve + 8 * (layout.CURVE + n), n),
        )
        return force * double(curve, layout.EFFICIENCY) * double(curve, layout.SUPPLY)

    # With numpy's error model a division by zero gives inf, as in C: nothing here can raise, so no exception code.
    options = {"error_model": "numpy"}
    return {
        "passive": numba.cfunc(types.void(types.int64, types.int64), **options)(passive),
        "thrust": numba.cfunc(types.double(types.int64, types.int64, types.int32), **options)(thrust),
    }
