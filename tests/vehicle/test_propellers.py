"""Propellers: closed forms, an integration by other means, what they can hold in an inflow, refusals."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support import plain_callbacks
from support.propelled import ASTERN, CURVED, REMUS, Propelled, Propeller
from support.water_bodies import DENSITY, Body, get_state, random_body, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.faults import set_efficiency, set_supply
from cube_sim.vehicle.laws import propeller as law

X, Y, Z = np.eye(3)
STERN = Propeller("stern", np.array([-0.7, 0.0, 0.0]), X)
HULL = Body(
    mass=30.0,
    cg=np.array([0.0, 0.0, -0.02]),
    inertia_at_cg=np.diag([0.2, 3.4, 3.4]),
    volume=0.03,
    added=np.diag([1.0, 35.0, 35.0, 0.07, 5.0, 5.0]),
    linear=np.diag([2.0, 30.0, 30.0, 0.5, 10.0, 10.0]),
    quadratic=np.diag([6.0, 200.0, 200.0, 0.5, 60.0, 60.0]),
)


def row(propeller: Propeller) -> tuple[np.ndarray, np.ndarray]:
    """Its row of the law's table, and its points."""
    ahead = REMUS if propeller.ahead is None else propeller.ahead
    astern = ahead if propeller.astern is None else propeller.astern
    found = np.zeros(law.COLUMNS)
    found[law.PLACE : law.AXIS], found[law.AXIS : law.RHO_D3] = propeller.place, propeller.axis
    found[law.RHO_D3], found[law.DIAMETER] = DENSITY * propeller.diameter**3, propeller.diameter
    found[law.ADVANCE], found[law.DELIVERED] = 1.0 - propeller.wake[0], 1.0 - propeller.wake[1]
    found[law.HAND] = propeller.hand
    found[law.SPEEDS : law.SLOWEST], found[law.SLOWEST : law.ARM] = propeller.speeds, propeller.slowest
    found[law.AHEAD : law.ASTERN] = 0, len(ahead)
    found[law.ASTERN :] = ahead.size, len(astern)
    return found, np.concatenate([ahead.ravel(), astern.ravel()])


KINDS = [STERN, replace(STERN, ahead=CURVED, astern=ASTERN), replace(STERN, ahead=CURVED, slowest=(3.0, 2.0))]


def test_the_law_is_its_formula_compiled_and_not():
    plain = plain_callbacks.plain("cube_sim.vehicle.laws.propeller")
    rng = np.random.default_rng(0)
    for propeller in KINDS:
        table, points = row(propeller)
        for _ in range(200):
            n, u = rng.uniform(-25.0, 25.0), rng.uniform(-3.0, 3.0)
            expected = propeller.open_water(n, u)
            for each in (law, plain):
                np.testing.assert_allclose(each.open_water(table, points, n, u), expected, rtol=1e-11, atol=1e-11)


def test_the_propeller_of_remus_is_the_published_linear_form():
    """T = rho D^4 (K_T0 n|n| + (K_Tmax - K_T0) / J_max V_a / D |n|), and so Q; by T. I. Fossen, ahead."""
    table, points = row(STERN)
    D = 0.14
    for n, U in ((1525.0 / 60.0, 2.5), (25.0, 1.54), (10.0, 0.3), (20.0, 0.0)):
        V_a = 0.944 * U
        thrust = DENSITY * D**4 * (0.4566 * n * n + (0.1798 - 0.4566) / 0.6632 * V_a / D * n)
        torque = DENSITY * D**5 * (0.0700 * n * n + (0.0312 - 0.0700) / 0.6632 * V_a / D * n)
        u_a = law.speed_of_advance(table, (U, 0.0, 0.0, 0.0, 0.0, 0.0))
        np.testing.assert_allclose(law.open_water(table, points, n, u_a), (thrust, torque), rtol=1e-12)
        assert law.thrust_at(table, points, n, u_a) == pytest.approx(0.9 * thrust)
    J_max = 0.944 * 2.5 / (D * 1525.0 / 60.0)
    assert pytest.approx(0.6632, abs=1e-4) == J_max
    at_most = law.open_water(table, points, 1525.0 / 60.0, 0.944 * 2.5)[0]
    assert at_most / (DENSITY * (1525.0 / 60.0) ** 2 * D**4) == pytest.approx(0.1798, rel=1e-3)


def test_in_all_four_quadrants_it_has_the_sign_it_must_have():
    """Bollard pull both ways; driven by the flow it brakes; standing it does nothing; and nothing jumps on the way."""
    for propeller in KINDS:
        table, points = row(propeller)
        for u in (-2.0, 0.0, 2.0):
            assert law.open_water(table, points, 0.0, u) == (0.0, 0.0)
            assert np.abs(law.open_water(table, points, 1e-9, u)).max() < 1e-6
        for n in (-20.0, -5.0, 5.0, 20.0):
            pushes = [law.thrust_at(table, points, n, u) for u in np.linspace(-3.0, 3.0, 200).tolist()]
            assert np.all(np.diff(pushes) < 0.0)  # water from ahead always takes thrust away
            assert law.thrust_at(table, points, n, 0.0) * n > 0.0
        assert law.thrust_at(table, points, 2.0, 2.0) < 0.0 < law.thrust_at(table, points, -2.0, -2.0)


def test_the_rotation_for_a_force_is_the_inverse_in_any_inflow():
    rng = np.random.default_rng(1)
    for propeller in KINDS:
        table, points = row(propeller)
        for _ in range(400):
            u = rng.uniform(-2.5, 2.5)
            limits = law.held_forces(table, points, u, 1.0)
            assert limits[0] <= limits[1] <= 0.0 <= limits[2] <= limits[3]
            for low, high in (limits[:2], limits[2:]):
                force = rng.uniform(low, high)
                if abs(force) < 1e-6 or low == high:
                    continue
                state = law.state_of_force(table, points, force, u, 1.0)
                assert -1.0 <= state <= 1.0
                made = law.thrust_at(table, points, law.rotation(table, state, 1.0), u)
                assert made == pytest.approx(force, rel=1e-9, abs=1e-9)


def test_the_limits_are_those_of_a_fine_table_of_rotations():
    """Every force that some rotation makes with its own sign lies within the limits, and their ends are made."""
    for propeller in KINDS:
        table, points = row(propeller)
        for u in (-1.5, 0.0, 0.7, 2.0):
            ahead = np.linspace(max(propeller.slowest[1], 1e-9), propeller.speeds[1], 20001).tolist()
            made = np.array([law.thrust_at(table, points, n, u) for n in ahead])
            lowest, below, above, highest = law.held_forces(table, points, u, 0.8)
            slower = np.array([law.thrust_at(table, points, n, u) for n in ahead if n <= 0.8 * propeller.speeds[1]])
            pushing = slower[slower > 0.0]
            assert highest == pytest.approx(pushing.max(initial=0.0), rel=1e-3, abs=1e-6)
            assert above == pytest.approx(pushing.min(initial=highest), rel=1e-3, abs=0.05)
            assert lowest <= below <= 0.0
            full = law.held_forces(table, points, u, 1.0)
            assert full[3] == pytest.approx(max(made[-1], 0.0))


def test_flow_from_ahead_takes_thrust_and_moves_the_dead_zone():
    table, points = row(replace(STERN, slowest=(5.0, 5.0)))
    at_rest, ahead = (np.array(law.held_forces(table, points, u, 1.0)) for u in (0.0, 1.0))
    assert np.all(ahead[[0, 1]] < at_rest[[0, 1]])
    assert np.all(ahead[[2, 3]] < at_rest[[2, 3]])
    assert law.held_forces(table, points, 9.0, 1.0)[2:] == (0.0, 0.0)  # faster than its pitch: no push ahead is left


@pytest.mark.parametrize("lags", [(0.15,), (0.05, 0.3)])
@pytest.mark.parametrize("seed", range(3))
def test_acceleration_is_fossens_with_propellers(lags, seed):
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    pair = tuple(
        replace(each, place=rng.uniform(-0.5, 0.5, 3), axis=axis, lags=lags, hand=hand, name=name)
        for each, axis, hand, name in zip(KINDS, axes, (1.0, -1.0, 0.0), "abc", strict=True)
    )
    propelled, state = Propelled(random_body(rng), pair), tumbling(rng)
    model = cube_sim.load_model(propelled.spec())
    data = mujoco.MjData(model)
    set_state(data, state)
    data.act[:], data.ctrl[:] = rng.uniform(-1.0, 1.0, model.na), rng.uniform(-1.0, 1.0, 3)
    mujoco.mj_forward(model, data)
    R = data.xmat[1].reshape(3, 3)
    nu_dot = np.concatenate([R.T @ data.qacc[:3] - np.cross(state[10:], state[7:10]), data.qacc[3:6]])
    expected = propelled.rate(np.concatenate([state, data.act]), data.ctrl)
    np.testing.assert_allclose(nu_dot, expected[7:13], atol=1e-11 * max(1.0, np.abs(expected).max()))
    np.testing.assert_allclose(data.act_dot, expected[13:], atol=1e-12 * np.abs(expected[13:]).max())


@pytest.mark.flight
@pytest.mark.parametrize(
    "propellers",
    [
        (replace(STERN, lags=(0.1,)),),
        (replace(STERN, ahead=CURVED, astern=ASTERN, lags=(0.05, 0.25)),),
    ],
    ids=["linear, one lag", "table, two lags"],
)
def test_steps_of_the_propeller_are_those_of_another_integrator(propellers):
    """Ahead, slower, backwards, stop: 30 s at 1.25 ms, against DOP853."""
    propelled = Propelled(replace(HULL, current=(0.2, 0.05, 0.0)), propellers)
    start = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.1, -0.1, 0.2, 0.1, -0.1])
    steps = [(0.0, [1.0]), (8.0, [0.4]), (14.0, [-0.8]), (20.0, [0.0]), (22.0, [0.7])]
    expected = propelled.reference(start, steps, 30.0)
    model = cube_sim.load_model(propelled.spec(0.00125))
    data = mujoco.MjData(model)
    set_state(data, start)
    for (begin, commands), end in zip(steps, [8.0, 14.0, 20.0, 22.0, 30.0], strict=True):
        data.ctrl[:] = commands
        mujoco.mj_step(model, data, nstep=round((end - begin) / 0.00125))
    found = np.concatenate([get_state(data), data.act])
    assert np.abs(found - expected).max() < 1e-6


def test_the_callbacks_are_the_uncompiled_ones():
    rng = np.random.default_rng(3)
    pair = replace(KINDS[1], name="a", lags=(0.1, 0.2), hand=-1.0), replace(KINDS[2], name="b", axis=Z)
    propelled, state = Propelled(random_body(rng), pair), tumbling(rng)
    model = cube_sim.load_model(propelled.spec(), {"water:surface": 0.5, "water:current": (0, 0, 0.1, 0.2, 0)})
    data = mujoco.MjData(model)
    set_state(data, state)
    data.act[:], data.ctrl[:] = (0.3, 0.8, -0.7), (0.5, -0.9)
    mujoco.mj_forward(model, data)
    expected, callbacks = data.qfrc_passive.copy(), plain_callbacks.callbacks()
    data.qfrc_passive[:] = 0.0
    callbacks["passive"](model._address, data._address)
    np.testing.assert_allclose(data.qfrc_passive, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    forces = [callbacks["thrust"](model._address, data._address, i) for i in range(2)]
    np.testing.assert_allclose(forces, data.actuator_force, rtol=1e-12)
    rates = data.act_dot.copy()
    callbacks["servo"](model._address, data._address, 0)
    np.testing.assert_allclose(data.act_dot, rates, rtol=1e-12)


def test_its_curve_and_limits_at_rest_are_those_of_a_thruster():
    propeller = replace(STERN, slowest=(2.0, 3.0), hand=-1.0)
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(Propelled(HULL, (propeller,)).spec()))
    table, points = row(propeller)
    np.testing.assert_allclose(vehicle.thrusters.limits[0], law.held_forces(table, points, 0.0, 1.0), rtol=1e-12)
    thrust, torque = propeller.open_water(25.0, 0.0)
    np.testing.assert_allclose(vehicle.actuation_matrix[:, 0], [1, 0, 0, torque / (0.9 * thrust), 0, 0], atol=1e-12)
    for command in (-0.9, -0.05, 0.05, 0.5, 1.0):
        expected = law.thrust_at(table, points, law.rotation(table, command, 1.0), 0.0)
        assert float(vehicle.thrusters.force([command])[0]) == pytest.approx(expected, rel=4e-3)  # a curve of chords


def test_health_and_voltage_act_on_the_propeller():
    """Half the voltage turns it half as fast; a damaged one gives less and turns the hull as before."""
    propelled = Propelled(HULL, (STERN,))
    model = cube_sim.load_model(propelled.spec())
    data = mujoco.MjData(model)
    set_state(data, np.array([0, 0, 0, 1, 0, 0, 0, 1.0, 0, 0, 0, 0, 0]))
    data.act[0] = 0.8
    inflow = (1.0 - STERN.wake[0]) * 1.0

    def thrust_and_roll() -> tuple[float, float]:
        mujoco.mj_forward(model, data)
        return float(data.actuator_force[0]), float(data.qfrc_actuator[3] + data.qfrc_passive[3])

    set_supply(model, "stern", 0.5)
    thrust, torque = STERN.open_water(10.0, inflow)
    assert thrust_and_roll() == pytest.approx((0.9 * thrust, -torque))
    set_supply(model, "stern", 1.0)
    thrust, torque = STERN.open_water(20.0, inflow)
    set_efficiency(model, "stern", 0.3)
    assert thrust_and_roll() == pytest.approx((0.27 * thrust, -torque))
    set_efficiency(model, "stern", 0.0)
    assert thrust_and_roll() == pytest.approx((0.0, 0.0))


def test_another_value_for_a_compiled_model_is_that_of_a_model_loaded_with_it():
    spec = Propelled(HULL, (STERN,)).spec()
    changes = {"stern:propeller_diameter": 0.2, "stern:propeller_open_water": REMUS.ravel() * 0.9}
    model, loaded = cube_sim.load_model(spec), cube_sim.load_model(spec, changes)
    cube_sim.set_parameters(model, changes)
    np.testing.assert_array_equal(model.numeric_data, loaded.numeric_data)
    np.testing.assert_array_equal(model.actuator_gear, loaded.actuator_gear)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"stern:propeller_diameter": 0.0}, "stern:propeller_diameter: is 0; a diameter .m. is positive"),
        ({"stern:propeller_speed": (0.0, 25.0)}, "speeds of rotation .rev/s."),
        ({"stern:propeller_speed": (1, 2, 3)}, "has 3 values; it takes 2"),
        ({"stern:propeller_open_water": (0.0, 0.4)}, "rows of 3: J, K_T, K_Q"),
        ({"stern:propeller_open_water": (0.0, 0.4, 0.05)}, "has 1 row J, K_T, K_Q; two at least"),
        ({"stern:propeller_open_water": (0.5, 0.4, 0.05, 0.2, 0.3, 0.04)}, "J increases from row to row"),
        ({"stern:propeller_open_water": (0.0, 0.3, 0.05, 0.5, 0.4, 0.04)}, "where J is above 0, K_T falls"),
        ({"stern:propeller_open_water": (0.2, 0.4, 0.05, 0.5, 0.3, 0.04)}, "rows from J = 0 or below"),
        ({"stern:propeller_open_water": (0.0, -0.4, 0.05, 0.5, -0.5, 0.04)}, "K_T above 0 there"),
        ({"stern:propeller_open_water": (0.0, 0.4, -0.05, 0.5, 0.3, 0.04)}, "has K_Q = -0.05 at J = 0"),
        (
            {"stern:propeller_open_water": (0.0, 0.4, 0.05, 0.5, 0.2, -0.01)},
            "has K_Q = -0.01 at J = 0.5, where it pushes; 0 or more",
        ),
        (
            {"stern:propeller_open_water": (0.0, 0.4, 0.05, 1.0, -0.4, -0.07)},
            "has K_Q = -0.01 at J = 0.5, where it pushes",
        ),
        (
            {"stern:propeller_open_water": (0.0, 0.4, 0.05, 0.5, 0.2, 0.01)},
            "has K_Q = -0.03 at J = 1, where it pushes, as its last line goes on; 0 or more",
        ),
        (
            {"stern:propeller_astern": (0.0, -0.3, -0.05, 0.5, -0.1, -0.02)},
            "propeller_astern: has K_T = -0.3 at J = 0; rows of a propeller that turns backwards, with the signs",
        ),
        ({"stern:propeller_linear": (0.4, -0.4, 0.05, -0.03)}, "stands beside stern:propeller_open_water"),
        ({"stern:propeller_wake": (1.2, 0.1)}, "w and t below 1"),
        ({"stern:propeller_slowest": (2.0, 30.0)}, "to below its full speed, 25 rev/s"),
        ({"stern:propeller_hand": 2.0}, "is 2; 1 .right-handed. or -1 .left-handed. is right"),
        ({"stern:propeller_hand": 0.0}, "is 0; 1 .right-handed. or -1 .left-handed. is right; left out, .* no torque"),
        ({"stern:propeler_wake": (0.1, 0.1)}, "did you mean propeller_wake"),
        ({"stern:thruster_characteristic": (-1, -1, 0, 0, 1, 1)}, "has a characteristic or is a propeller, not both"),
        ({"sten:propeller_diameter": 0.1}, "no body or thruster 'sten'"),
    ],
)
def test_what_makes_no_sense_is_refused(parameters, told):
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(Propelled(HULL, (STERN,)).spec(), parameters)


def test_straight_lines_on_which_it_pushes_and_is_turned_are_refused():
    """K_T reaches 0 at J = a_T / -b_T, K_Q at a_Q / -b_Q: it may not be before."""
    spec = Propelled(HULL, (STERN,)).spec()
    spec.delete(next(n for n in spec.numerics if n.name == "stern:propeller_open_water"))
    cube_sim.load_model(spec, {"stern:propeller_linear": (0.4, -0.4, 0.05, -0.0499)})
    with pytest.raises(ModelError, match=r"has K_Q = -0.01 at J = 1, where it pushes"):
        cube_sim.load_model(spec, {"stern:propeller_linear": (0.4, -0.4, 0.05, -0.06)})


def test_a_propeller_may_turn_by_itself_where_it_brakes():
    rows = (0.0, 0.4, 0.05, 0.8, 0.1, 0.02, 1.0, -0.03, 0.004, 1.4, -0.3, -0.03)
    cube_sim.load_model(Propelled(HULL, (STERN,)).spec(), {"stern:propeller_open_water": rows})


def test_a_propeller_that_lacks_its_biastype_is_told_so():
    spec = Propelled(HULL, (STERN,)).spec()
    spec.actuators[0].biastype = mujoco.mjtBias.mjBIAS_NONE
    told = "stern:propeller_[a-z_]*: is of the actuator 'stern', which is no thruster; biastype=\"user\" makes it one"
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(spec)


@pytest.mark.parametrize("missing", ["diameter", "speed", "open_water"])
def test_what_is_missing_is_named(missing):
    spec = Propelled(HULL, (STERN,)).spec()
    spec.delete(next(n for n in spec.numerics if n.name == f"stern:propeller_{missing}"))
    with pytest.raises(ModelError, match=f"stern:propeller_{missing}: is missing; propeller 'stern' needs"):
        cube_sim.load_model(spec)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"gear": [0, 0, 1, 0, 0, 0.1]}, "its torque follows from K_Q and propeller_hand"),
        ({"dyntype": mujoco.mjtDyn.mjDYN_USER}, "has a lag .dynprm. of 0 s of two; with dyntype .user. both are"),
        ({"dyntype": mujoco.mjtDyn.mjDYN_USER, "dynprm": [0.1, 0.0005] + [0.0] * 8}, "its lag of 0.0005 s is unstable"),
    ],
)
def test_an_actuator_that_would_not_run_as_it_says_is_refused(change, told):
    spec = Propelled(HULL, (STERN,)).spec()
    for name, value in change.items():
        setattr(spec.actuators[0], name, value)
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(spec)
