"""Fins, body lift and cross-flow drag: closed forms, an integration by other means, refusals."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support import plain_callbacks
from support.lifting import Fin, Lifted, random_lifted
from support.places import CUBE
from support.water_bodies import DENSITY, Body, get_state, random_body, set_state, tumbling

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.fins import Fins
from cube_sim.vehicle.laws import fin as law
from cube_sim.vehicle.mjcf.fins import helmbold

X, Y, Z = np.eye(3)
RUDDER = Fin("rudder", np.array([-0.6, 0.0, 0.0]), X, Y, 0.01, 3.0, servo=(0.1, 0.5))
FOIL = replace(RUDDER, stall=0.3)
HULL = Body(added=np.diag([1.0, 10.0, 10.0, 0.1, 1.0, 1.0])).neutral()


def row(fin: Fin) -> np.ndarray:
    induced = 1.0 / (np.pi * fin.drag[1] * fin.aspect)
    stall = np.inf if fin.stall is None else fin.stall
    numbers = 0.5 * DENSITY * fin.area, fin.slope, stall, fin.drag[0], induced, -1.0
    return np.array([0.0, *fin.place, *fin.chord, *fin.normal, *numbers])


def flying(lifted: Lifted, timestep: float = 0.005, **parameters):
    model = cube_sim.load_model(lifted.spec(timestep), parameters)
    return model, mujoco.MjData(model)


def test_the_law_is_its_formula_compiled_and_not():
    plain = plain_callbacks.plain("cube_sim.vehicle.laws.fin")
    rng = np.random.default_rng(0)
    for fin in random_lifted(rng, HULL).fins * 20:
        nu, angle = rng.normal(size=6), rng.uniform(-0.5, 0.5)
        force = fin.force(nu, angle)
        expected = [*force, *np.cross(fin.place, force)]
        for each in (law, plain):
            found = each.fin_wrench(row(fin), angle, tuple(nu.tolist()))
            np.testing.assert_allclose(found, expected, atol=1e-12 * max(1.0, np.abs(expected).max()))


def test_below_stall_it_is_prandtls_beyond_a_flat_plate():
    fin, U = row(FOIL), 1.7
    pressure = 0.5 * DENSITY * FOIL.area * U**2
    along, across = law.foil_force(fin, 0.1, U, 0.0)
    assert across == pytest.approx(pressure * 3.0 * 0.1, rel=1e-3)
    assert -along == pytest.approx(pressure * (0.01 + 0.3**2 / (np.pi * 0.9 * 3.0)), rel=1e-3)
    along, across = law.foil_force(fin, 0.0, 0.0, -U)  # broadside
    assert across == pytest.approx(pressure * 2.01, rel=1e-9)
    assert abs(along) < 1e-9 * across
    peak = max(law.coefficients(a, 3.0, 0.3, 0.01, 0.1)[0] for a in np.linspace(0.0, 1.5, 300).tolist())
    assert 0.7 < peak < 0.9  # it stalls at 0.3 rad
    assert law.foil_force(fin, 0.2, 0.0, 0.0) == (0.0, 0.0)


def test_a_fixed_deflection_does_no_work_but_by_its_drag():
    """Lift is across the flow, at any angle, astern too."""
    rng = np.random.default_rng(1)
    dragless = row(FOIL)
    for _ in range(200):
        u, n, angle = rng.normal(), rng.normal(), rng.uniform(-0.5, 0.5)
        along, across = law.foil_force(dragless, angle, u, n)
        attack = np.angle(np.exp(1j * angle) * (u - 1j * n))
        C_D = law.coefficients(float(attack), *(float(x) for x in dragless[[11, 12, 13, 14]]))[1]
        power = -dragless[10] * np.hypot(u, n) ** 3 * C_D
        assert along * u + across * n == pytest.approx(power, rel=1e-9)
        assert power < 0.0


def test_the_flow_is_that_at_the_fin():
    """A hull that turns about its fin pushes no water there; the same motion in moving water is another flow."""
    plain = replace(RUDDER, servo=None)
    for current, place, silent in (((0.0, 0.0, 0.0), -0.6, True), ((0.0, 0.2, 0.0), -0.6, False)):
        lifted = Lifted(replace(HULL, current=current, added=np.zeros((6, 6))), (plain,))
        model, data = flying(lifted)
        set_state(data, np.array([0, 0, 0, 1, 0, 0, 0, 1.0, -place * 0.5, 0, 0, 0, 0.5]))
        mujoco.mj_forward(model, data)
        assert bool(abs(data.qfrc_passive[1]) < 1e-12) is silent


@pytest.mark.parametrize("seed", range(10))
def test_acceleration_is_fossens_with_lift(seed):
    rng = np.random.default_rng(seed)
    lifted, state = random_lifted(rng, random_body(rng)), tumbling(rng)
    model, data = flying(lifted)
    set_state(data, state)
    data.act[:] = rng.uniform(-0.5, 0.5, 2)
    mujoco.mj_forward(model, data)
    R = data.xmat[1].reshape(3, 3)
    nu_dot = np.concatenate([R.T @ data.qacc[:3] - np.cross(state[10:], state[7:10]), data.qacc[3:6]])
    expected = lifted.rate(np.concatenate([state, data.act]), data.ctrl)[7:13]
    np.testing.assert_allclose(nu_dot, expected, atol=1e-11 * max(1.0, np.abs(expected).max()))


@pytest.mark.flight
@pytest.mark.parametrize("seed", [0, 1])
def test_motion_is_that_of_another_integrator(seed):
    """Servos at their rate and lagging, fins stalled and not, current, strips and products: 3 s at 2.5 ms."""
    rng = np.random.default_rng(seed)
    lifted, start, targets = random_lifted(rng, random_body(rng)), tumbling(rng), np.array([0.3, -0.4])
    expected = lifted.reference(start, targets, 3.0)
    model, data = flying(lifted, 0.0025)
    set_state(data, start)
    data.ctrl[:] = targets
    mujoco.mj_step(model, data, nstep=1200)
    found = np.concatenate([get_state(data), data.act])
    assert np.abs(found[:13] - expected[:13]).max() < 1e-6
    assert np.abs(found[13:] - expected[13:]).max() < 1e-6


def test_the_callbacks_are_the_uncompiled_ones():
    rng = np.random.default_rng(3)
    lifted, state = random_lifted(rng, random_body(rng)), tumbling(rng)
    model, data = flying(lifted)
    set_state(data, state)
    data.act[:], data.ctrl[:] = (0.2, -0.1), (0.7, -0.12)
    mujoco.mj_forward(model, data)
    expected, callbacks = data.qfrc_passive.copy(), plain_callbacks.callbacks()
    data.qfrc_passive[:] = 0.0
    callbacks["passive"](model._address, data._address)
    np.testing.assert_allclose(data.qfrc_passive, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    rates = [callbacks["servo"](model._address, data._address, i) for i in range(2)]
    np.testing.assert_allclose(data.act_dot, rates)
    np.testing.assert_allclose(rates, [0.8, -0.1], atol=1e-12)  # the end of its travel is far, the other one is near


def test_a_servo_keeps_its_rate_its_lag_and_its_travel():
    model, data = flying(Lifted(HULL, (RUDDER,)))
    data.ctrl[:] = 2.0
    mujoco.mj_step(model, data, nstep=100)
    assert data.act[0] == pytest.approx(0.5 * 0.5, abs=1e-9)
    mujoco.mj_step(model, data, nstep=900)
    assert data.act[0] == pytest.approx(0.5, abs=1e-9)


def test_a_controller_sees_what_the_fins_can_do_at_their_speed():
    rng = np.random.default_rng(5)
    lifted = random_lifted(rng, HULL)
    model = cube_sim.load_model(lifted.spec())
    fins = Fins.from_model(model)
    assert fins.names == ("a", "b")
    np.testing.assert_array_equal(fins.actuators, [0, 1])
    np.testing.assert_allclose(fins.travel, [[-0.5, 0.5]] * 2)
    np.testing.assert_allclose([*fins.lag_s, *fins.rate], [0.1, 0.2, 0.8, 0.5])
    nu, angles = rng.normal(size=6), np.array([0.1, -0.05])
    effect = fins.effectiveness(angles, nu)
    np.testing.assert_allclose(fins.effectiveness(angles, 2.0 * nu), 4.0 * effect, rtol=1e-6)
    np.testing.assert_array_equal(fins.effectiveness(angles, np.zeros(6)), 0.0)
    total = sum((lifted.fins[k].force(nu, angles[k]) for k in range(2)), np.zeros(3))
    np.testing.assert_allclose(fins.wrench(angles, nu)[:3], total, atol=1e-9)
    for k in range(2):
        step = np.eye(2)[k] * 1e-4
        literal = (fins.wrench(angles + step, nu) - fins.wrench(angles - step, nu)) / 2e-4
        np.testing.assert_allclose(effect[:, k], literal, atol=1e-6)
    assert Fins.from_model(cube_sim.load_model(CUBE)).names == ()


def test_several_vehicles_have_their_own():
    """A vehicle attached with a prefix flies as it flies alone."""
    rng = np.random.default_rng(4)
    lifted, state = random_lifted(rng, random_body(rng)), tumbling(rng)
    alone = lifted.spec()
    whole = mujoco.MjSpec()
    whole.option.timestep, whole.option.integrator = 0.005, mujoco.mjtIntegrator.mjINT_RK4
    whole.option.wind = alone.option.wind
    whole.compiler.autolimits = True
    for prefix in ("one/", "two/"):
        whole.attach(alone.copy(), prefix=prefix, frame=whole.worldbody.add_frame())
    both = cube_sim.load_model(whole)
    data = mujoco.MjData(both)
    for k in range(2):
        data.qpos[7 * k : 7 * k + 7] = state[:7]
        data.qpos[7 * k] += 100.0 * k
        data.ctrl[2 * k : 2 * k + 2] = (0.1, 0.2)
    model, single = flying(lifted)
    set_state(single, state)
    data.qvel[:6] = data.qvel[6:] = single.qvel
    single.ctrl[:] = (0.1, 0.2)
    mujoco.mj_step(model, single, nstep=100)
    mujoco.mj_step(both, data, nstep=100)
    np.testing.assert_array_equal(data.qvel[:6], single.qvel)
    np.testing.assert_allclose(data.qvel[6:], single.qvel, rtol=0.0, atol=1e-13)  # 100 m away, other roundings


def test_the_slope_follows_from_the_aspect_ratio():
    assert helmbold(1e9) == pytest.approx(2.0 * np.pi)
    assert helmbold(1e-3) == pytest.approx(0.5 * np.pi * 1e-3, rel=1e-3)  # R. T. Jones's slender wing


@pytest.mark.parametrize(
    ("fin", "parameters", "told"),
    [
        (RUDDER, {"rudder:fin_area": 0.0}, "rudder:fin_area: is 0; an area"),
        (RUDDER, {"rudder:fin_drag": (0.01, 0.9)}, "give 'fin_stall' too"),
        (RUDDER, {"rudder:fin_aera": 1.0}, "did you mean fin_area"),
        (RUDDER, {"helm:fin_area": 1.0}, "no site or body 'helm'; the model has rudder, hull"),
        (FOIL, {"rudder:fin_stall": 2.0}, "below pi/2"),
        (FOIL, {"rudder:fin_drag": (0.01, 1.2)}, "0 < e <= 1"),
        (FOIL, {"rudder:fin_drag": 0.01}, "has 1 value; it takes 2"),
        (replace(RUDDER, servo=(0.0, 0.5)), {}, "its lag .s. and its rate .rad/s. are positive"),
        (replace(RUDDER, servo=(0.001, 0.5)), {}, "unstable under RK4 with a time step of 0.005 s; take a step below"),
        (RUDDER, {"hull:velocity_products": (7, 1, 1, 2.0)}, "axis, j and k are 1 to 6"),
        (RUDDER, {"hull:velocity_products": (1, 1, 2.0)}, "rows of 4"),
        (RUDDER, {"rudder:fin_products": (1, 1, 1, 3, 2.0)}, "n = 3; 1, the deflection, or 2, its square"),
        (RUDDER, {"rudder:fin_products": (1, 1, 7, 1, 2.0)}, "begins 1 1 7; axis, j and k are 1 to 6"),
        (RUDDER, {"rudder:fin_products": (1, 1, 1, 2.0)}, "rows of 5"),
        (RUDDER, {"hull:fin_products": (1, 1, 1, 1, 2.0)}, "no site 'hull'; the model has rudder"),
        (RUDDER, {"hull:coriolis_of_added_mass": 2.0}, "or 1 is right"),
        (RUDDER, {"hull:cross_flow_drag": (1.0, 1.0)}, "has no hull to act on"),
        (RUDDER, {"hull:cross_flow_stations": (0.0, 1.0, 1.0)}, "needs C_Dy and C_Dz"),
    ],
)
def test_what_makes_no_sense_is_refused(fin, parameters, told):
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(Lifted(HULL, (fin,)).spec(), parameters)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"gainprm": [1.0] + [0.0] * 9}, "is at fin 'rudder' and no servo"),
        ({"dyntype": mujoco.mjtDyn.mjDYN_FILTER}, "is at fin 'rudder' and no servo"),
        ({"ctrllimited": mujoco.mjtLimited.mjLIMITED_FALSE}, "the fin's travel about 0"),
        ({"delay": 0.1}, "has a delay"),
    ],
)
def test_what_is_no_servo_is_refused(change, told):
    spec = Lifted(HULL, (RUDDER,)).spec()
    for name, value in change.items():
        setattr(spec.actuators[0], name, value)
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(spec)


def test_a_servo_without_a_fin_is_refused():
    spec = Lifted(HULL, (RUDDER,)).spec()
    for numeric in [each for each in spec.numerics if each.name.startswith("rudder:fin_")]:
        spec.delete(numeric)
    with pytest.raises(ModelError, match="turns no fin: site 'rudder' has no area; give rudder:fin_area"):
        cube_sim.load_model(spec)


@pytest.mark.parametrize("speed", [0.4, 1.5])
def test_less_travel_leaves_the_force_of_what_is_left(speed):
    """The linear form makes rho / 2 S a u^2 for a radian; a foil with stall what its own law says there."""
    lifted = Lifted(HULL, fins=(RUDDER, replace(FOIL, name="plane", normal=Z, place=np.array([-0.6, 0.1, 0.0]))))
    fins = Fins.from_model(cube_sim.load_model(lifted.spec(0.005)))
    at_speed, (low, high) = fins.at_speed(speed), fins.travel[0].tolist()
    rudder, plane = fins.names.index("rudder"), fins.names.index("plane")

    def within(*travel):
        limits = at_speed.limits_within(np.array([travel, travel]))
        return limits[rudder, [0, 3]], limits[plane, [0, 3]]

    whole = at_speed.limits[[rudder, plane]][:, [0, 3]]
    np.testing.assert_array_equal(within(-np.inf, np.inf), whole)
    np.testing.assert_array_equal(within(low, high), whole)
    per_radian = 0.5 * DENSITY * RUDDER.area * RUDDER.slope * speed**2
    np.testing.assert_allclose(within(-0.02, 0.07)[0], sorted(per_radian * np.array([-0.02, 0.07])), rtol=1e-6)
    np.testing.assert_allclose(within(-5.0, 0.07)[0], [whole[0][0], per_radian * 0.07], rtol=1e-6)
    for travel in ((0.02, 0.07), (-0.07, -0.02)):  # it always pushes to one side: none of it counts
        assert all((limits == 0.0).all() for limits in within(*travel))
    short = within(-0.11, 0.03)[1]
    ahead = (speed, 0.0, 0.0, 0.0, 0.0, 0.0)
    lift = [law.fin_wrench(fins.table[plane], angle, ahead)[2] for angle in (-0.11, 0.03)]
    np.testing.assert_allclose(short, sorted(np.array(lift)), rtol=1e-3)
