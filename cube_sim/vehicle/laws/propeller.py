"""Thrust and torque of a propeller in its inflow, by its open-water coefficients.

With n the speed of rotation, D the diameter, u_a = (1 - w) u the speed of advance and J = u_a / (n D),

    T = rho n |n| D^4 K_T(J),  Q = rho n |n| D^5 K_Q(J).

The hull gets (1 - t) T. K_T and K_Q are straight lines between the points of a table, one for n > 0 and one for n < 0,
and go on beyond its ends as they end there: on each line K = a + b J, so that

    T = rho D^3 (a D n |n| + b |n| u_a),

which is the bilinear form of manoeuvring models (T. I. Fossen, Guidance and Control of Ocean Vehicles, 1994, section
4.1.2: T_nn = rho D^4 a, T_|n|u = rho D^3 b), has no singularity at n = 0, and leaves a propeller that stands without
force. J is positive where the water runs the way the propeller drives it, for both senses of rotation.

The speed follows the command with a lag or, where a motor is known, by the torques on the shaft, w = 2 pi n,

    I w' = K (U - K w) / R - Q - b w - Q_0 clip(w / w_0, -1, 1):

a motor of constant K [N m/A], which is [V s/rad] as well, and resistance R at a voltage U, its inductance left out;
what the water takes; friction, viscous and dry, the latter evened out below w_0.
"""

from __future__ import annotations

from math import pi, sqrt

from cube_sim.native.compiled import compiled

HULL, ACTUATOR, ACTIVATION, CURVE, PLACE, AXIS = 0, 1, 2, 3, 4, 7
RHO_D3, DIAMETER, ADVANCE, DELIVERED, HAND = 10, 11, 12, 13, 14
SPEEDS, SLOWEST, ARM = 15, 17, 19
MOTOR, RESISTANCE, INERTIA, DRY, VISCOUS, VOLTAGE, DRIVE = 20, 21, 22, 23, 24, 25, 26
AHEAD, ASTERN = 27, 29
"""Columns of a table of propellers, a row each.

Number of the hull; index of the actuator; where the rotor's state lies among the activations; where its curve record
begins; place (3) from the body origin [m] and axis (3), the way it pushes, in body axes; rho D^3 [kg]; D [m]; 1 - w;
1 - t; 1 for a right-handed propeller, -1 for a left-handed one, 0 for one that leaves no torque to the hull; speed of
rotation [rev/s] at the commands -1 and 1, both above 0; those below which it stands, backwards and ahead; torque that
the hull gets of MuJoCo per newton [m]; K [N m/A], 0 for one without a motor, R [ohm], I [kg m^2], Q_0 [N m], b [N m s],
the voltage U of full command [V]; share of the electrical power that arrives at the shaft, 0 where nobody knows, and
with a motor, whose equation says it; and where the open-water points begin and how many, ahead and astern. With a
motor the speeds are those at full command in water that does not flow: units in which the rotor's state is counted.
"""
COLUMNS = 31
POINT = 3
"""An open-water point: J, K_T, K_Q."""
TWO_PI = 2.0 * pi
DRY_BELOW = 0.02
"""Share of the speed without load below which dry friction is evened out (a choice): w_0."""
HALVINGS, DOUBLINGS = 60, 8
"""Of the search for the speed at which the torques on a shaft balance."""
STANDS = 1e-12
"""Speed of rotation below which a propeller counts as standing [rev/s]: J is a number above."""


@compiled
def line_at(points, begin, count, J, column):
    """(a, b) of K = a + b J around an advance ratio.

    Args:
        points: (n,) numbers with open-water points among them, J increasing.
        begin: where they begin.
        count: how many, two at least.
        J: advance ratio; infinite for one that stands.
        column: 1 for K_T, 2 for K_Q.
    """
    low = 0
    while low < count - 2 and points[begin + POINT * (low + 1)] <= J:
        low += 1
    at = begin + POINT * low
    run = points[at + POINT] - points[at]
    b = (points[at + POINT + column] - points[at + column]) / run
    return points[at + column] - b * points[at], b


@compiled
def open_water(row, points, n, u_a):
    """(T, Q) of a propeller [N, N m], without thrust deduction; T along its axis, Q what turns it.

    Args:
        row: (`COLUMNS`,) of the table.
        points: numbers in which its open-water points lie.
        n: speed of rotation [rev/s].
        u_a: speed of advance [m/s].
    """
    if abs(n) < STANDS:
        return 0.0, 0.0
    D, turning = row[DIAMETER], abs(n)
    J, side = u_a / (n * D), AHEAD if n > 0.0 else ASTERN
    begin, count = int(row[side]), int(row[side + 1])
    a, b = line_at(points, begin, count, J, 1)
    thrust = row[RHO_D3] * turning * (D * n * a + u_a * b)
    a, b = line_at(points, begin, count, J, 2)
    return thrust, row[RHO_D3] * D * turning * (D * n * a + u_a * b)


@compiled
def thrust_at(row, points, n, u_a):
    """Force on the hull [N]: (1 - t) T; arguments as in `open_water`."""
    return row[DELIVERED] * open_water(row, points, n, u_a)[0]


@compiled
def rotation(row, state, voltage_ratio):
    """Speed of rotation [rev/s] of a rotor's state, a lagged command; 0 below the slowest.

    Args:
        row: (`COLUMNS`,) of the table.
        state: a command after the lag, -1 to 1.
        voltage_ratio: supply voltage over that of the speeds.
    """
    side = 1 if state > 0.0 else 0
    if row[MOTOR] > 0.0:  # the state is the speed itself
        return state * row[SPEEDS + side]
    n = state * row[SPEEDS + side] * voltage_ratio
    return 0.0 if abs(n) < row[SLOWEST + side] else n


@compiled
def speed_of_advance(row, nu_r):
    """u_a [m/s] of a hull's velocity through the water, a 6-tuple, body axes [m/s, rad/s]."""
    x, y, z = row[PLACE], row[PLACE + 1], row[PLACE + 2]
    along = row[AXIS] * (nu_r[0] + nu_r[4] * z - nu_r[5] * y)
    along += row[AXIS + 1] * (nu_r[1] + nu_r[5] * x - nu_r[3] * z)
    along += row[AXIS + 2] * (nu_r[2] + nu_r[3] * y - nu_r[4] * x)
    return row[ADVANCE] * along


@compiled
def load_torque(row, points, n, u_a):
    """What a shaft takes to turn steadily [N m]: the water and friction; arguments as in `open_water`."""
    w, w_0 = TWO_PI * n, DRY_BELOW * row[VOLTAGE] / row[MOTOR]
    return open_water(row, points, n, u_a)[1] + row[VISCOUS] * w + row[DRY] * min(max(w / w_0, -1.0), 1.0)


@compiled
def motor_torque(row, n, volts):
    """K (U - K w) / R [N m] of a motor at a speed [rev/s] and a voltage [V]."""
    return row[MOTOR] * (volts - row[MOTOR] * TWO_PI * n) / row[RESISTANCE]


@compiled
def shaft_rate(row, points, state, volts, u_a):
    """How fast the state of a rotor with a motor changes [1/s].

    Args:
        row: (`COLUMNS`,) of the table.
        points: numbers in which its open-water points lie.
        state: of it, its speed in units of `SPEEDS`.
        volts: at its motor [V].
        u_a: speed of advance [m/s].
    """
    n = rotation(row, state, 1.0)
    turning = (motor_torque(row, n, volts) - load_torque(row, points, n, u_a)) / (TWO_PI * row[INERTIA])
    side = 1 if state > 0.0 or (state == 0.0 and turning > 0.0) else 0
    return turning / row[SPEEDS + side]


@compiled
def balanced_speed(row, points, volts, u_a):
    """Speed of rotation [rev/s] at which the torques on a shaft balance; arguments as in `shaft_rate`."""
    sign = 1.0 if volts >= 0.0 else -1.0
    low, high = 0.0, abs(volts) / (row[MOTOR] * TWO_PI) + 1e-9
    for _ in range(DOUBLINGS):  # water that drives the propeller turns it faster than its motor alone
        n = sign * high
        if sign * (motor_torque(row, n, volts) - load_torque(row, points, n, u_a)) <= 0.0:
            break
        low, high = high, 2.0 * high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        n = sign * middle
        if sign * (motor_torque(row, n, volts) - load_torque(row, points, n, u_a)) > 0.0:
            low = middle
        else:
            high = middle
    return sign * 0.5 * (low + high)


@compiled
def command_of_speed(row, points, n, u_a, voltage_ratio):
    """The command that holds a speed of rotation [rev/s] of a shaft with a motor; the nearest there is."""
    volts = row[MOTOR] * TWO_PI * n + row[RESISTANCE] / row[MOTOR] * load_torque(row, points, n, u_a)
    return min(max(volts / (row[VOLTAGE] * voltage_ratio), -1.0), 1.0)


@compiled
def fastest(row, points, u_a, ahead, voltage_ratio):
    """Largest speed of rotation [rev/s], with its sign, ahead or astern; arguments as in `rotation`, `open_water`."""
    if row[MOTOR] > 0.0:
        volts = row[VOLTAGE] * voltage_ratio
        return balanced_speed(row, points, volts if ahead else -volts, u_a)
    return row[SPEEDS + 1] * voltage_ratio if ahead else -row[SPEEDS] * voltage_ratio


@compiled
def held_forces(row, points, u_a, voltage_ratio):
    """[F_max-, F_DZ-, F_DZ+, F_max+] [N] of a propeller in its inflow, a 4-tuple.

    On each side from the slowest rotation to the fastest, as far as the force has the sign of the rotation.
    """
    most, least = (
        fastest(row, points, u_a, True, voltage_ratio),
        fastest(row, points, u_a, False, voltage_ratio),
    )
    highest = max(thrust_at(row, points, most, u_a), 0.0)
    lowest = min(thrust_at(row, points, least, u_a), 0.0)
    above = min(max(thrust_at(row, points, min(row[SLOWEST + 1], most), u_a), 0.0), highest)
    below = max(min(thrust_at(row, points, max(-row[SLOWEST], least), u_a), 0.0), lowest)
    return lowest, below, above, highest


@compiled
def rotation_of(row, points, force, u_a):
    """Speed of rotation [rev/s] at which the hull gets a force [N] in an inflow u_a [m/s]; 0 for no force.

    On each line K_T = a + b J the force is quadratic in n. Of a line's answers the one that lies on it counts; where
    rounding leaves none, between two, the line on whose side they part.
    """
    if force == 0.0:
        return 0.0
    ahead = force > 0.0
    sign, side = (1.0, AHEAD) if ahead else (-1.0, ASTERN)
    begin, count, D = int(row[side]), int(row[side + 1]), row[DIAMETER]
    wanted, u = sign * force / (row[DELIVERED] * row[RHO_D3]), sign * u_a
    found = 0.0
    for low in range(count - 1):
        at = begin + POINT * low
        J_low, J_high = points[at], points[at + POINT]
        b = (points[at + POINT + 1] - points[at + 1]) / (J_high - J_low)
        a = points[at + 1] - b * J_low
        root = sqrt(max((b * u) ** 2 + 4.0 * D * a * wanted, 0.0))
        # The same root written twice, each without a difference of like numbers.
        if b * u > 0.0:
            n = 2.0 * wanted / (b * u + root)
        elif a > 0.0:
            n = (root - b * u) / (2.0 * D * a)
        else:
            continue
        J = u / (n * D)
        found = n
        if (low == count - 2 or J_high >= J) and (low == 0 or J_low <= J):
            break
        if low < count - 2 and J_low > J:  # between this line and the one before
            break
    return sign * found


@compiled
def state_of_force(row, points, force, u_a, voltage_ratio):
    """The command that holds a force [N] in an inflow; forces beyond its limits get the nearest one.

    A force inside the dead zone gets the nearest of 0 and its edge, as `Characteristic.command` gives it.
    """
    lowest, below, above, highest = held_forces(row, points, u_a, voltage_ratio)
    if force > 0.0 and force >= 0.5 * above and highest > 0.0:
        n = rotation_of(row, points, min(force, highest), u_a)
        if row[MOTOR] > 0.0:
            return command_of_speed(row, points, n, u_a, voltage_ratio)
        most = fastest(row, points, u_a, True, voltage_ratio)
        n = min(max(n, row[SLOWEST + 1] * (1.0 + 1e-12)), most)
        return n / most
    if force < 0.0 and force <= 0.5 * below and lowest < 0.0:
        n = rotation_of(row, points, max(force, lowest), u_a)
        if row[MOTOR] > 0.0:
            return command_of_speed(row, points, n, u_a, voltage_ratio)
        most = fastest(row, points, u_a, False, voltage_ratio)
        n = max(min(n, -row[SLOWEST] * (1.0 + 1e-12)), most)
        return n / -most
    return 0.0


@compiled
def lag_rates(command, first, second, lag_s, rotor_lag_s):
    """How fast two lags in a row follow a command [1/s]: (that of the speed controller, that of the rotor).

    Args:
        command: -1 to 1.
        first: state of the speed controller.
        second: of the rotor.
        lag_s: time constant of the first [s].
        rotor_lag_s: of the second [s].
    """
    return (command - first) / lag_s, (first - second) / rotor_lag_s
