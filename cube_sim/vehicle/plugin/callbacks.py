"""The three callbacks MuJoCo runs, as Python that numba compiles.

`passive` replaces the inertia of every hull by M_RB + M_A, adds that of the water on its links, and adds the remaining
water forces to `qfrc_passive`. MuJoCo itself then solves for the acceleration: added mass is implicit, never lagged.
`thrust` evaluates the thruster
characteristic on the lagged command, or a propeller in its inflow. `servo` turns the fins, the rotors that follow their
command through two lags, and the state of own forces.

They keep no state and find their parameters inside the model (`cube_sim.vehicle.plugin.layout`). For a model that is
not ours they return at once, also while it is being compiled.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt

import numba
from numba import types

from cube_sim.tuples import minus, plus6, stacked, to_body
from cube_sim.vehicle.laws.ballast import ACTUATOR as PUMP
from cube_sim.vehicle.laws.ballast import HULL as BALLAST_OF_HULL
from cube_sim.vehicle.laws.ballast import SITE, STATE, ballast_wrench
from cube_sim.vehicle.laws.current import current_at, velocity_at
from cube_sim.vehicle.laws.fin import HULL as FIN_OF_HULL
from cube_sim.vehicle.laws.fin import servo_rate
from cube_sim.vehicle.laws.hydrodynamics import relative_velocity
from cube_sim.vehicle.laws.propeller import (
    ACTIVATION,
    ACTUATOR,
    AXIS,
    CURVE,
    MOTOR,
    VOLTAGE,
    lag_rates,
    shaft_rate,
    speed_of_advance,
)
from cube_sim.vehicle.laws.propeller import HULL as OF_HULL
from cube_sim.vehicle.laws.push import COLUMNS, push_wrench
from cube_sim.vehicle.laws.servo_fault import ACTUATOR as TURNS
from cube_sim.vehicle.laws.servo_fault import COLUMNS as SERVO_COLUMNS
from cube_sim.vehicle.laws.servo_fault import FIN, LOOSE, faulty_rate, loose_rate
from cube_sim.vehicle.laws.surface import faded, share_of_depth
from cube_sim.vehicle.plugin import layout
from cube_sim.vehicle.plugin.ballast_record import ballast_rows, with_tanks
from cube_sim.vehicle.plugin.curve_record import steady_force
from cube_sim.vehicle.plugin.inertia import put_factors, put_inertia
from cube_sim.vehicle.plugin.lift_record import fin_row, lift_wrench
from cube_sim.vehicle.plugin.link_water import build_link_water
from cube_sim.vehicle.plugin.memory import (
    call_force,
    double,
    field,
    force_table,
    integer,
    matrix,
    put,
    room_for_hull,
    room_for_inertia,
    vector,
)
from cube_sim.vehicle.plugin.propeller_wrench import propeller_force, table_of, unheld_torque
from cube_sim.vehicle.plugin.under_water import under_water
from cube_sim.vehicle.plugin.water_on_body import water_on_body

_factor_mass_matrix = types.ExternalFunction("mj_factorM", types.void(types.int64, types.int64))
_project_constraints = types.ExternalFunction("mj_projectConstraint", types.void(types.int64, types.int64))


@numba.njit
def _not_a_number():
    """The wrench of what cannot be computed: MuJoCo warns of it at the first step, on any thread."""
    nan = float("nan")
    return (nan, nan, nan, nan, nan, nan)


@numba.njit
def _user_wrench(function, process, time, position, rotation, nu, nu_r, seen):
    """The wrench of the hull's own force, a 6-tuple; the rates of its state are put where they belong.

    It is not a number for a model from another process, whose functions are not here.
    """
    table = force_table()
    if double(table, 0) != process:
        return _not_a_number()
    return call_force(field(table, 8 * (function + 1)), time, position, rotation, nu, nu_r, seen)


def build(model: Mapping[str, int], data: Mapping[str, int], codes: Mapping[str, int]) -> dict:
    """Compile the callbacks for one memory layout.

    Args:
        model: byte offsets of the fields of mjModel.
        data: byte offsets of the fields of mjData.
        codes: MuJoCo's numbers for "no_gravity", the disable flag that switches gravity off and buoyancy with it;
            "no_passive", the two that together skip `passive`; "pgs", the solver; and "dynprm", how many parameters
            the dynamics of an actuator have.

    Returns:
        numba cfuncs "passive" (model, data), "thrust" and "servo" (model, data, actuator).
    """
    nnumeric, numeric_adr, numeric_data = model["nnumeric"], model["numeric_adr"], model["numeric_data"]
    opt_gravity, opt_wind, opt_disableflags = model["opt.gravity"], model["opt.wind"], model["opt.disableflags"]
    opt_density, opt_viscosity, opt_timestep = model["opt.density"], model["opt.viscosity"], model["opt.timestep"]
    opt_solver, opt_noslip = model["opt.solver"], model["opt.noslip_iterations"]
    no_gravity, no_passive, pgs = codes["no_gravity"], codes["no_passive"], codes["pgs"]
    dof_armature, m_rowadr, actuator_actadr = model["dof_armature"], model["M_rowadr"], model["actuator_actadr"]
    actuator_actnum, actuator_ctrlrange = model["actuator_actnum"], model["actuator_ctrlrange"]
    actuator_dynprm, dynprm = model["actuator_dynprm"], codes["dynprm"]
    time_, qvel, xpos, xmat, act = data["time"], data["qvel"], data["xpos"], data["xmat"], data["act"]
    ctrl = data["ctrl"]
    cdof, crb, mass, qfrc_passive = data["cdof"], data["crb"], data["M"], data["qfrc_passive"]
    actuator_trnid, site_size, site_xpos = model["actuator_trnid"], model["site_size"], data["site_xpos"]
    nv, qld, qldiaginv = model["nv"], data["qLD"], data["qLDiagInv"]
    act_dot, userdata = data["act_dot"], data["userdata"]

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
        if field(address, 0) != layout.MAGIC_BITS:
            return 0
        return address

    @numba.njit
    def share_of_site(m, d, packed, site):
        """Share of a site that is under water, by its depth and its size."""
        depth = double(packed, layout.SURFACE) - double(field(d, site_xpos), 3 * site + 2)
        radius = double(field(m, site_size), 3 * site)
        return share_of_depth(depth, radius) if depth < radius else 1.0

    @numba.njit
    def share_under_water(m, d, packed, actuator):
        """Share of a thruster that is under water."""
        return share_of_site(m, d, packed, integer(field(m, actuator_trnid), 2 * actuator))

    @numba.njit
    def through_water(m, d, packed, hull):
        """Velocity of a hull through the water, a 6-tuple, body axes; by the address of its record."""
        body, dof = int(double(hull, layout.BODY)), int(double(hull, layout.DOF))
        R, v = matrix(field(d, xmat) + 72 * body, 3, 3), field(d, qvel) + 8 * dof
        current = (double(m + opt_wind, 0), double(m + opt_wind, 1), double(m + opt_wind, 2))
        profile = int(double(packed, layout.CURRENT))
        if profile >= 0:
            table = packed + 8 * profile
            n_t, n_z = int(double(table, 0)), int(double(table, 1))
            times, heights = vector(table + 16, n_t), vector(table + 16 + 8 * n_t, n_z)
            velocities = matrix(table + 16 + 8 * (n_t + n_z), n_t * n_z, 3)
            height = double(field(d, xpos) + 24 * body, 2)
            there = velocity_at(double(d + time_, 0), height, times, heights, velocities)
            current = (current[0] + there[0], current[1] + there[1], current[2] + there[2])
        relative = to_body(R, minus((double(v, 0), double(v, 1), double(v, 2)), current))
        return stacked(relative, (double(v, 3), double(v, 4), double(v, 5)))

    @numba.njit
    def torques_of_propellers(m, d, packed, hull, nu_r):
        """What the propellers of a hull, by its number, turn it by beside their gears, a 6-tuple [N, N m]."""
        total = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        rows, points = table_of(packed + 8 * int(double(packed, layout.PROPELLERS)))
        for k in range(rows.shape[0]):
            row = rows[k]
            if row[OF_HULL] == hull:
                curve, state = packed + 8 * int(row[CURVE]), double(field(d, act), int(row[ACTIVATION]))
                turning = unheld_torque(row, points, curve, state, nu_r)
                turning *= share_under_water(m, d, packed, int(row[ACTUATOR]))
                torque = (0.0, 0.0, 0.0, turning * row[AXIS], turning * row[AXIS + 1], turning * row[AXIS + 2])
                total = plus6(total, torque)
        return total

    @numba.njit
    def water_at(m, packed, time, height, steady):
        """Current and its acceleration at a height, two 3-tuples in world axes."""
        profile = int(double(packed, layout.CURRENT))
        if profile < 0:
            return steady, (0.0, 0.0, 0.0)
        table = packed + 8 * profile
        n_t, n_z = int(double(table, 0)), int(double(table, 1))
        return current_at(
            time,
            height,
            vector(table + 16, n_t),
            vector(table + 16 + 8 * n_t, n_z),
            matrix(table + 16 + 8 * (n_t + n_z), n_t * n_z, 3),
            steady,
            double(m + opt_timestep, 0),
        )

    put_arm, put_link = build_link_water(model, data, water_at)

    @numba.njit
    def rate_of(m, d, actuator, state):
        """How fast a servo or a pump moves its state, by its command [1/s of its unit]."""
        travel, prm = field(m, actuator_ctrlrange) + 16 * actuator, field(m, actuator_dynprm) + 8 * dynprm * actuator
        target = min(max(double(field(d, ctrl), actuator), double(travel, 0)), double(travel, 1))
        return servo_rate(target, state, double(prm, 0), double(prm, 1))

    @numba.njit
    def wrench_of_ballast(m, d, packed, hull, down, nu, nu_r):
        """What the ballast of a hull, by its number, does to it, a 6-tuple [N, N m]; gravity in body axes."""
        total = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        rows = ballast_rows(packed + 8 * int(double(packed, layout.BALLAST)))
        for k in range(rows.shape[0]):
            row = rows[k]
            if row[BALLAST_OF_HULL] == hull:
                volume = double(field(d, act), int(row[STATE]))
                rate, share = rate_of(m, d, int(row[PUMP]), volume), share_of_site(m, d, packed, int(row[SITE]))
                total = plus6(total, ballast_wrench(row, volume, rate, share, down, nu, nu_r))
        return total

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
        count, pushes = int(double(packed, layout.COUNT)), int(double(packed, layout.PUSHES))
        lift = int(double(packed, layout.LIFT))
        surface, propellers = double(packed, layout.SURFACE), double(packed, layout.PROPELLERS) >= 0.0
        links = int(double(packed, layout.LINK_COUNT))
        factored = field(m, nv) == 6 * count and links == 0  # hulls are all there is, each a block of its own
        ballast = int(double(packed, layout.BALLAST))
        for k in range(count):
            hull = packed + 8 * (int(double(packed, layout.HULLS)) + k * layout.HULL_SIZE)
            body, dof = int(double(hull, layout.BODY)), int(double(hull, layout.DOF))
            position, rotation = field(d, xpos) + 24 * body, field(d, xmat) + 72 * body
            R = matrix(rotation, 3, 3)
            wet, share, gradient = hull, 1.0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            at_surface = double(position, 2) + double(hull, layout.REACH) > surface
            if at_surface:
                wet, share, gradient = under_water(hull, room_for_hull(), position, R, surface)
            rows, moved = field(m, m_rowadr) + 4 * dof, wet + 8 * layout.ADDED_MASS
            if ballast >= 0:
                tanks = ballast_rows(packed + 8 * ballast)
                moved = with_tanks(tanks, float(k), field(d, act), moved, room_for_inertia())
            put_inertia(
                matrix(moved, 6, 6),
                R,
                matrix(field(d, cdof) + 48 * dof, 6, 6),
                vector(field(d, crb) + 80 * body, 10),
                field(m, dof_armature) + 8 * dof,
                rows,
                field(d, mass),
            )
            arm = int(double(hull, layout.ARM))
            if arm > 0:
                put_arm(m, d, dof + 6, arm)
            if factored:
                factored = put_factors(field(d, mass), rows, field(d, qld), field(d, qldiaginv) + 8 * dof)
            v = field(d, qvel) + 8 * dof
            over_ground = (double(v, 0), double(v, 1), double(v, 2))
            nu = stacked(to_body(R, over_ground), (double(v, 3), double(v, 4), double(v, 5)))
            current, surge = water_at(m, packed, time, double(position, 2), steady)
            nu_r = relative_velocity(R, nu, current)
            F = water_on_body(hull, wet, at_surface, gradient, profile >= 0, R, nu, nu_r, surge, down)
            if pushes >= 0:
                table = packed + 8 * pushes
                from_outside = matrix(table + 8, int(double(table, 0)), COLUMNS)
                F = plus6(F, push_wrench(from_outside, float(k), R, time, double(m + opt_timestep, 0)))
            if lift >= 0:
                lifted = lift_wrench(packed + 8 * lift, float(k), field(d, act), nu_r)
                if at_surface:
                    lifted = faded(share, lifted)
                F = plus6(F, lifted)
            if ballast >= 0:
                F = plus6(F, wrench_of_ballast(m, d, packed, float(k), to_body(R, down), nu, nu_r))
            if propellers:
                F = plus6(F, torques_of_propellers(m, d, packed, float(k), nu_r))
            function = int(double(hull, layout.FORCE))
            if function >= 0:
                seen = (
                    field(d, ctrl) + 8 * int(double(hull, layout.COMMAND)),
                    int(double(hull, layout.COMMANDS)),
                    field(d, act) + 8 * int(double(hull, layout.ACTIVATION)),
                    int(double(hull, layout.ACTIVATIONS)),
                    field(d, act) + 8 * int(double(hull, layout.STATE)),
                    int(double(hull, layout.STATES)),
                    field(d, userdata) + 8 * int(double(hull, layout.RATES)),
                )
                process = double(packed, layout.PROCESS)
                F = plus6(F, _user_wrench(function, process, time, position, rotation, nu, nu_r, seen))
            if double(m + opt_density, 0) != 0.0 or double(m + opt_viscosity, 0) != 0.0:
                F = _not_a_number()  # MuJoCo's own fluid model was switched on later: every force twice
            force = field(d, qfrc_passive) + 8 * dof
            for i in range(3):
                put(force, i, double(force, i) + R[i, 0] * F[0] + R[i, 1] * F[1] + R[i, 2] * F[2])
                put(force, 3 + i, double(force, 3 + i) + F[3 + i])
        for k in range(links):
            link = packed + 8 * (int(double(packed, layout.LINKS)) + k * layout.HULL_SIZE)
            put_link(m, d, packed, link, steady, down)
        if not factored:
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
        under_water = share_under_water(m, d, packed, actuator)
        if stuck == stuck:  # a number: the thruster holds that force whatever the command
            return stuck * double(curve, layout.SUPPLY) * under_water
        adr = integer(field(m, actuator_actadr), actuator) + integer(field(m, actuator_actnum), actuator) - 1
        propeller = int(double(curve, layout.PROPELLER))
        if propeller >= 0:
            rows, points = table_of(packed + 8 * int(double(packed, layout.PROPELLERS)))
            row = rows[propeller]
            hull = packed + 8 * (int(double(packed, layout.HULLS)) + int(row[OF_HULL]) * layout.HULL_SIZE)
            nu_r = through_water(m, d, packed, hull)
            return propeller_force(row, points, curve, double(field(d, act), adr), nu_r) * under_water
        force = steady_force(double(field(d, act), adr), curve)
        return force * double(curve, layout.EFFICIENCY) * double(curve, layout.SUPPLY) * under_water

    @numba.njit
    def put_rates(packed, d, state):
        """The rates of an own force, which `passive` has found, to the activations from there on; the first of them."""
        first = 0.0
        for k in range(int(double(packed, layout.COUNT))):
            hull = packed + 8 * (int(double(packed, layout.HULLS)) + k * layout.HULL_SIZE)
            n = int(double(hull, layout.STATES))
            if n > 0 and int(double(hull, layout.STATE)) == state:
                rates = int(double(hull, layout.RATES))
                first = double(field(d, userdata), rates)
                for i in range(n):
                    put(field(d, act_dot), state + i, double(field(d, userdata), rates + i))
        return first

    @numba.njit
    def rate_of_shaft(m, d, packed, curve, row, points, adr):
        """How fast the state of a rotor with a motor changes [1/s], by its curve record and where its states begin."""
        hull = packed + 8 * (int(double(packed, layout.HULLS)) + int(row[OF_HULL]) * layout.HULL_SIZE)
        u_a = speed_of_advance(row, through_water(m, d, packed, hull))
        volts = double(field(d, act), adr) * row[VOLTAGE] * sqrt(double(curve, layout.SUPPLY))
        return shaft_rate(row, points, double(field(d, act), adr + 1), volts, u_a)

    @numba.njit
    def rate_of_fin(m, d, packed, actuator, deflection):
        """How fast a servo turns its fin [rad/s], its faults counted in."""
        travel, prm = field(m, actuator_ctrlrange) + 16 * actuator, field(m, actuator_dynprm) + 8 * dynprm * actuator
        target = min(max(double(field(d, ctrl), actuator), double(travel, 0)), double(travel, 1))
        servos = packed + 8 * int(double(packed, layout.SERVOS))
        rows = matrix(servos + 8, int(double(servos, 0)), SERVO_COLUMNS)
        for k in range(rows.shape[0]):
            row = rows[k]
            if row[TURNS] == actuator:
                if row[LOOSE] == 0.0:
                    return faulty_rate(row, target, deflection, double(prm, 0), double(prm, 1))
                fin = fin_row(packed + 8 * int(double(packed, layout.LIFT)), int(row[FIN]))
                hull = packed + 8 * (int(double(packed, layout.HULLS)) + int(fin[FIN_OF_HULL]) * layout.HULL_SIZE)
                return loose_rate(fin, deflection, double(prm, 0), through_water(m, d, packed, hull))
        return servo_rate(target, deflection, double(prm, 0), double(prm, 1))

    def servo(m, d, actuator):
        packed = parameters_of(m)
        if packed == 0:
            return 0.0
        record = int(double(packed, int(double(packed, layout.THRUSTERS)) + actuator))
        if record == layout.FORCE_STATE:
            return put_rates(packed, d, integer(field(m, actuator_actadr), actuator))
        if record == layout.NO_THRUSTER:
            return 0.0
        adr = integer(field(m, actuator_actadr), actuator)
        deflection = double(field(d, act), adr)
        if record >= 0:
            travel, parameters = field(m, actuator_ctrlrange) + 16 * actuator, dynprm * actuator
            target = min(max(double(field(d, ctrl), actuator), double(travel, 0)), double(travel, 1))
            prm = field(m, actuator_dynprm)
            if int(double(packed + 8 * record, layout.PROPELLER)) >= 0:
                rows, points = table_of(packed + 8 * int(double(packed, layout.PROPELLERS)))
                row = rows[int(double(packed + 8 * record, layout.PROPELLER))]
                if row[MOTOR] > 0.0:
                    put(field(d, act_dot), adr, (target - deflection) / double(prm, parameters))
                    turning = rate_of_shaft(m, d, packed, packed + 8 * record, row, points, adr)
                    put(field(d, act_dot), adr + 1, turning)
                    return 0.0
            lags = double(prm, parameters), double(prm, parameters + 1)
            first, second = lag_rates(target, deflection, double(field(d, act), adr + 1), lags[0], lags[1])
            put(field(d, act_dot), adr, first)
            put(field(d, act_dot), adr + 1, second)
            return 0.0
        if record == layout.BALLAST_STATE:
            return rate_of(m, d, actuator, deflection)
        return rate_of_fin(m, d, packed, actuator, deflection)

    # With numpy's error model a division by zero gives inf, as in C: nothing here can raise, so no exception code.
    options = {"error_model": "numpy"}
    return {
        "passive": numba.cfunc(types.void(types.int64, types.int64), **options)(passive),
        "thrust": numba.cfunc(types.double(types.int64, types.int64, types.int32), **options)(thrust),
        "servo": numba.cfunc(types.double(types.int64, types.int64, types.int32), **options)(servo),
    }
