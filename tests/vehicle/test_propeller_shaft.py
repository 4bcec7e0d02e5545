"""The shaft of a propeller by the balance of its torques: closed forms, DOP853, what it can hold, refusals."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support import plain_callbacks
from support.propelled import ASTERN, CURVED, REMUS
from support.water_bodies import DENSITY

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.battery import Battery
from cube_sim.vehicle.faults import set_supply
from cube_sim.vehicle.laws import propeller as law
from cube_sim.vehicle.power_supply import PowerSupply
from cube_sim.vehicle.thrusters import Thrusters
from cube_sim.vehicle.vehicle import Vehicle

D, K, R, INERTIA, DRY, VISCOUS, VOLTS, T1 = 0.14, 0.06, 0.5, 4e-4, 0.02, 2e-4, 24.0, 0.02
WAKE, DEDUCTION, MASS, DRAG, ADDED = 0.056, 0.1, 30.0, 6.0, 1.0


def words(values) -> str:
    return " ".join(f"{float(value)!r}" for value in np.ravel(values))


def model_of(ahead=REMUS, astern=None, dynprm=f"{T1} 1", shaft=(INERTIA, DRY, VISCOUS), motor=(K, R), voltage=VOLTS,
             more="", kind="user", timestep=0.0005) -> mujoco.MjModel:  # fmt: skip
    numbers = {
        "propeller_diameter": D,
        "propeller_open_water": ahead,
        "propeller_wake": (WAKE, DEDUCTION),
        "propeller_hand": 1.0,
        "propeller_motor": motor,
        "propeller_shaft": shaft,
        "thruster_voltage": voltage,
        "propeller_astern": astern,
    }
    given = "".join(
        f'<numeric name="stern:{name}" data="{words(value)}"/>' for name, value in numbers.items() if value is not None
    )
    return cube_sim.load_model(
        mujoco.MjSpec.from_string(f"""<mujoco><option timestep="{timestep}" integrator="RK4" gravity="0 0 0"/>
      <custom><numeric name="water:density" data="{DENSITY}"/><numeric name="hull:volume" data="{MASS / DENSITY!r}"/>
        <numeric name="hull:added_mass" data="{ADDED} 30 30 0.1 5 5"/>
        <numeric name="hull:quadratic_damping" data="{DRAG} 200 200 50 60 60"/>{given}{more}</custom>
      <worldbody><body name="hull"><freejoint/><inertial pos="0 0 0" mass="{MASS}" diaginertia="0.2 3 3"/>
        <site name="stern" pos="-0.7 0 0" zaxis="1 0 0"/></body></worldbody>
      <actuator><general name="stern" site="stern" gear="0 0 1 0 0 0" dyntype="{kind}" dynprm="{dynprm}" gainprm="0"
        biastype="user"/></actuator></mujoco>""")
    )


def coefficients(table, J):
    i = int(np.clip(np.searchsorted(table[:, 0], J) - 1, 0, len(table) - 2))
    share = (J - table[i, 0]) / (table[i + 1, 0] - table[i, 0])
    return table[i, 1:] + share * (table[i + 1, 1:] - table[i, 1:])


def water(n, u_a, ahead, astern):
    """Thrust and torque [N, N m]."""
    if n == 0.0:
        return 0.0, 0.0
    K_T, K_Q = coefficients(ahead if n > 0 or astern is None else astern, u_a / (n * D))
    return DENSITY * n * abs(n) * D**4 * K_T, DENSITY * n * abs(n) * D**5 * K_Q


def net(n, volts, u_a, ahead=REMUS, astern=None):
    w, w_0 = 2 * np.pi * n, 0.02 * VOLTS / K
    friction = VISCOUS * w + DRY * np.clip(w / w_0, -1, 1)
    return K * (volts - K * w) / R - water(n, u_a, ahead, astern)[1] - friction


@pytest.mark.parametrize(("ahead", "astern"), [(REMUS, None), (CURVED, ASTERN)], ids=["linear", "table"])
def test_a_dash_and_a_stop_by_another_integration(ahead, astern):
    """Voltage, shaft, hull and its roll, full ahead, half ahead, then astern."""
    model = model_of(ahead, astern)
    steps = [(0.0, 1.0), (3.0, 0.4), (5.0, -0.7)]
    speeds = Vehicle.from_model(model).thrusters.propellers.rows[0, law.SPEEDS : law.SLOWEST]

    def slope(t, y, command):
        _, u, c, n, p = y
        T, Q = water(n, (1 - WAKE) * u, ahead, astern)
        turning = net(n, c * VOLTS, (1 - WAKE) * u, ahead, astern)
        surge = ((1 - DEDUCTION) * T - DRAG * abs(u) * u) / (MASS + ADDED)
        return [u, surge, (command - c) / T1, turning / (2 * np.pi * INERTIA), (-Q - 50 * abs(p) * p) / 0.3]

    state, data = np.zeros(5), mujoco.MjData(model)
    for (begin, command), end in zip(steps, (3.0, 5.0, 7.0), strict=True):
        given = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12, "max_step": 0.002, "args": (command,)}
        state = solve_ivp(slope, (begin, end), state, **given).y[:, -1]
        data.ctrl[0] = command
        mujoco.mj_step(model, data, nstep=round((end - begin) / model.opt.timestep))
        n = data.act[1] * speeds[int(data.act[1] > 0)]
        assert data.qpos[0] == pytest.approx(state[0], rel=3e-6)
        assert data.qvel[0] == pytest.approx(state[1], rel=3e-6)
        assert n == pytest.approx(state[3], rel=3e-6)
        assert data.qvel[3] == pytest.approx(state[4], rel=3e-6)


@pytest.mark.parametrize("ratio", [1.0, 0.7])
@pytest.mark.parametrize("command", [1.0, 0.35, -0.6])
def test_it_settles_where_the_torques_balance(command, ratio):
    """At the voltage that feeds it, in water that does not flow and in water that does."""
    model = model_of()
    set_supply(model, "stern", ratio)
    row = Vehicle.from_model(model).thrusters.propellers.rows[0]
    for speed in (0.0, 1.2):
        u_a, data = (1 - WAKE) * speed, mujoco.MjData(model)
        n = brentq(lambda n, u=u_a: net(n, command * ratio * VOLTS, u), -80, 80, xtol=1e-13)
        data.qvel[0], data.ctrl[0] = speed, command
        data.act[:] = command, n / row[law.SPEEDS + int(n > 0)]
        mujoco.mj_forward(model, data)
        assert data.act_dot == pytest.approx([0.0, 0.0], abs=1e-9)
        thrust = (1 - DEDUCTION) * water(n, u_a, REMUS, None)[0]
        assert data.actuator_force[0] == pytest.approx(thrust, rel=1e-9)


@pytest.mark.parametrize("u_a", [-0.8, 0.0, 0.6, 2.5])
@pytest.mark.parametrize("ratio", [1.0, 0.8])
def test_a_command_for_a_force_holds_it(u_a, ratio):
    """And limits are what full voltage holds in that inflow."""
    table = Vehicle.from_model(model_of()).thrusters.propellers
    row, points = table.rows[0], table.points
    low, _, _, high = law.held_forces(row, points, u_a, ratio)
    for force in np.linspace(0.98 * low, 0.98 * high, 9):
        if abs(force) < 0.5:
            continue
        command = law.state_of_force(row, points, force, u_a, ratio)
        n = law.balanced_speed(row, points, command * ratio * VOLTS, u_a)
        assert law.thrust_at(row, points, n, u_a) == pytest.approx(force, rel=3e-6)
        assert net(n, command * ratio * VOLTS, u_a) == pytest.approx(0.0, abs=1e-9)
    assert law.state_of_force(row, points, 10 * high, u_a, ratio) == pytest.approx(1.0, abs=1e-9)
    n = brentq(lambda n: net(n, ratio * VOLTS, u_a), 1e-6, 300, xtol=1e-13)
    assert high == pytest.approx(max((1 - DEDUCTION) * water(n, u_a, REMUS, None)[0], 0.0), rel=1e-9, abs=1e-9)


def test_its_curve_is_that_of_water_at_rest():
    thrusters = Thrusters.from_model(model := model_of(CURVED, ASTERN), model.body("hull").id)
    for command in np.linspace(-1, 1, 41):
        n = brentq(lambda n, U=command * VOLTS: net(n, U, 0.0, CURVED, ASTERN), -90, 90, xtol=1e-13)
        expected = (1 - DEDUCTION) * water(n, 0.0, CURVED, ASTERN)[0]
        assert thrusters.force([command])[0] == pytest.approx(expected, abs=0.01 * abs(thrusters.limits).max())
    slope = (net(10.0 - 1e-4, 0, 0) - net(10.0 + 1e-4, 0, 0)) / (4e-4 * np.pi)
    assert 0.5 * INERTIA / slope < thrusters.lag_s[0] - T1 < INERTIA / (K**2 / R)


@pytest.mark.parametrize("battery", [None, Battery(26.0, 0.4)], ids=["constant", "battery"])
def test_what_a_motor_draws_goes_into_water_friction_the_shaft_and_heat(battery):
    """Full ahead, more, less, astern; the power that comes back while it brakes is not taken up."""
    model = model_of(timestep=0.001)
    data, thrusters = mujoco.MjData(model), Vehicle.from_model(model).thrusters
    supply, row, rows = PowerSupply(model, thrusters, battery), thrusters.propellers.rows[0], []
    for command, steps in ((0.5, 1500), (1.0, 1500), (0.9, 500), (-0.6, 1500)):
        data.ctrl[0] = command
        for _ in range(steps):
            mujoco.mj_forward(model, data)
            supply.update(data)
            n, u_a = data.act[1] * row[law.SPEEDS + int(data.act[1] > 0)], (1 - WAKE) * data.qvel[0]
            w, volts = 2 * np.pi * n, data.act[0] * supply.voltage
            I_A = (volts - K * w) / R
            friction = VISCOUS * w + DRY * np.clip(w / (0.02 * VOLTS / K), -1, 1)
            taken = (water(n, u_a, REMUS, None)[1] + friction) * w + R * I_A**2
            rows.append((taken, supply.power[0], w, volts * I_A, supply.voltage))
            mujoco.mj_step(model, data)
    taken, power, w, both_ways, voltage = np.array(rows).T
    np.testing.assert_allclose(power, np.maximum(both_ways, 0.0), rtol=1e-11, atol=1e-11)
    stored = 0.5 * INERTIA * (w[-1] ** 2 - w[0] ** 2)
    spent = np.trapezoid(taken, dx=0.001) + stored
    assert spent == pytest.approx(np.trapezoid(both_ways, dx=0.001), rel=3e-4)
    assert supply.energy == pytest.approx(np.trapezoid(power, dx=0.001), rel=1e-12)
    assert supply.energy > np.trapezoid(both_ways, dx=0.001) > 100.0  # it has braked
    if battery is not None:
        np.testing.assert_allclose(voltage, 26.0 - 0.4 * power / voltage, rtol=1e-11)
        assert voltage.min() < 25.0


def test_another_motor_is_as_if_it_had_been_loaded():
    model, other = model_of(), model_of(motor=(0.05, 0.3), shaft=(6e-4, 0.01, 0.0))
    cube_sim.set_parameters(model, {"stern:propeller_motor": [0.05, 0.3], "stern:propeller_shaft": [6e-4, 0.01, 0.0]})
    assert np.array_equal(model.numeric_data, other.numeric_data, equal_nan=True)
    assert model.actuator_dynprm.tobytes() == other.actuator_dynprm.tobytes()


@pytest.mark.parametrize("seed", range(3))
def test_the_compiled_callbacks_are_their_plain_python(seed):
    rng = np.random.default_rng(seed)
    model = model_of(CURVED, ASTERN)
    data = mujoco.MjData(model)
    data.qvel[:], data.act[:], data.ctrl[:] = rng.normal(size=6), rng.uniform(-1, 1, 2), rng.uniform(-1, 1)
    mujoco.mj_forward(model, data)
    compiled, force = data.act_dot.copy(), data.actuator_force[0]
    plain = plain_callbacks.callbacks()
    plain["servo"](model._address, data._address, 0)
    assert data.act_dot.tobytes() == compiled.tobytes()
    assert plain["thrust"](model._address, data._address, 0) == force


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"shaft": None}, "propeller_shaft is missing|propeller_shaft: is missing"),
        ({"motor": None}, "propeller_motor: is missing"),
        ({"voltage": None}, "thruster_voltage: is missing"),
        ({"motor": (0.0, 1.0)}, "positive"),
        ({"more": '<numeric name="hull:propeller_efficiency" data="0.7"/>'}, "what a motor loses follows from its K_t"),
        ({"more": '<numeric name="stern:thruster_power" data="1 1"/>'}, "stands beside stern:propeller_motor"),
        ({"shaft": (0.0, 0.0, 0.0)}, "above 0"),
        ({"shaft": (1e-4, 9.0, 0.0)}, "dry friction"),
        ({"kind": "filter", "dynprm": "0.1"}, 'dyntype="user"'),
        ({"more": '<numeric name="stern:propeller_speed" data="20"/>'}, "stands beside"),
        ({"shaft": (1e-7, 0.0, 0.0)}, "unstable"),
        ({"shaft": (1e-5, 2.0, 0.0)}, "settles within"),
    ],
)
def test_one_line_says_what_is_wrong(given, word):
    with pytest.raises(ModelError, match=word) as told:
        model_of(**given)
    assert "\n" not in str(told.value)
