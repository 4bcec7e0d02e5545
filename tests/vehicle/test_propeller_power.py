"""What propellers draw: the torque on the shaft times its speed, a motor by its equation, and the energy of both."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support import plain_callbacks
from support.propelled import ASTERN, CURVED, Propelled, Propeller
from support.water_bodies import Body, random_body, set_state, tumbling

import cube_sim
from cube_sim.commands.drafted_battery import drafted_battery
from cube_sim.errors import ModelError
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle import faults
from cube_sim.vehicle.battery import Battery
from cube_sim.vehicle.laws import propeller_power as law
from cube_sim.vehicle.power_supply import PowerSupply

ETA, VOLTS = 0.65, 24.0
X, Z = np.eye(3)[[0, 2]]
STERN = Propeller("stern", np.array([-0.7, 0.0, 0.1]), X, ahead=CURVED, astern=ASTERN, lags=(0.05, 0.15))
SIDE = Propeller("side", np.array([0.2, 0.1, -0.1]), Z, hand=-1.0)
HULL = Body(
    mass=30.0,
    inertia_at_cg=np.diag([0.2, 3.4, 3.4]),
    volume=0.03,
    added=np.diag([1.0, 35.0, 35.0, 0.07, 5.0, 5.0]),
    linear=np.diag([2.0, 30.0, 30.0, 0.5, 10.0, 10.0]),
    quadratic=np.diag([6.0, 200.0, 200.0, 0.5, 60.0, 60.0]),
)
DRIVEN = {f"{each}:{what}": value for each in ("stern", "side")
          for what, value in (("propeller_efficiency", ETA), ("thruster_voltage", VOLTS))}  # fmt: skip


def supplied(propelled, parameters=DRIVEN, battery=None):
    model = cube_sim.load_model(propelled.spec(), parameters)
    return model, mujoco.MjData(model), PowerSupply(model, cube_sim.Vehicle.from_model(model).thrusters, battery)


def drawn(propelled, state, states, ratio=1.0):
    """Electrical power [W] of whole propellers, by the formulas and nothing of cube_sim's laws."""
    R = rotation_from_quaternion(state[3:7])
    nu_r = state[7:] - np.concatenate([R.T @ propelled.body.current, np.zeros(3)])
    power = []
    for each, s in zip(propelled.propellers, states, strict=True):
        n = each.rotation(s) * ratio
        flow = float(each.axis @ (nu_r[:3] + np.cross(nu_r[3:], each.place)))
        power.append(max(each.open_water(n, (1.0 - each.wake[0]) * flow)[1] * 2.0 * np.pi * n, 0.0) / ETA)
    return np.array(power)


@pytest.mark.parametrize("seed", range(4))
def test_it_is_torque_times_speed_in_any_motion_and_current(seed):
    rng = np.random.default_rng(seed)
    propelled = Propelled(random_body(rng), (STERN, SIDE))
    model, data, supply = supplied(propelled)
    some = 0.0
    for _ in range(20):
        state = tumbling(rng)
        set_state(data, state)
        data.act[:] = rng.uniform(-1.0, 1.0, 3)
        mujoco.mj_forward(model, data)
        supply.update(data)
        expected = drawn(propelled, state, (data.act[1], data.act[2]))
        np.testing.assert_allclose(supply.power, expected, rtol=1e-10, atol=1e-10)
        some += expected.sum()
    assert some > 10.0


def test_the_energy_of_a_dash_is_the_integral_of_torque_times_speed():
    """By an integration of hull, rotors and energy apart, and steadily at the end."""
    propelled = Propelled(HULL, (STERN, SIDE))
    model, data, supply = supplied(propelled)
    state = np.array([0, 0, 0, 1, 0, 0, 0, 0.5, 0, 0, 0, 0, 0], dtype=float)
    set_state(data, state)
    data.ctrl[:], dt = (0.8, 0.1), 0.01

    def rate(_, y):
        return [*propelled.rate(y[:-1], data.ctrl), drawn(propelled, y[:13], (y[14], y[15])).sum()]

    solved = solve_ivp(rate, (0.0, 6.0), [*state, 0, 0, 0, 0], method="DOP853", rtol=1e-10, atol=1e-10)
    for k in range(601):
        mujoco.mj_forward(model, data)
        supply.update(data)
        if k < 600:
            mujoco.mj_step(model, data, nstep=round(dt / model.opt.timestep))
    assert supply.energy == pytest.approx(solved.y[-1, -1], rel=2e-5)
    assert supply.energy > 100.0


@pytest.mark.parametrize("resistance", [0.02, 0.3, 2.0])
def test_under_load_voltage_and_power_agree(resistance):
    """V = E - R P(V) / V, by a search apart; two updates of one state give the same."""
    propelled = Propelled(HULL, (STERN, SIDE))
    model, data, supply = supplied(propelled, battery=Battery(25.2, resistance))
    state = np.array([0, 0, 0, 1, 0, 0, 0, 0.6, 0.1, -0.2, 0.1, 0.2, 0.1])
    set_state(data, state)
    data.act[:] = 0.9, 0.9, 0.4
    mujoco.mj_forward(model, data)
    expected = brentq(
        lambda V: 25.2 - resistance * drawn(propelled, state, (0.9, 0.4), V / VOLTS).sum() / V - V,
        1.0,
        25.2,
        xtol=1e-13,
    )
    for _ in range(2):
        supply.update(data)
        assert supply.voltage == pytest.approx(expected, rel=1e-12)
        np.testing.assert_allclose(supply.power, drawn(propelled, state, (0.9, 0.4), expected / VOLTS), rtol=1e-11)
    assert expected < 25.1
    thrust = STERN.open_water(STERN.rotation(0.9) * expected / VOLTS, 0.944 * (0.6 + 0.2 * 0.1))[0]
    assert data.actuator_force[0] == pytest.approx(0.9 * thrust, rel=1e-9)


def test_faults_and_the_surface():
    """A dead motor draws nothing, a damaged propeller what a whole one does, a stuck one what its force takes."""
    propelled = Propelled(HULL, (replace(STERN, place=np.array([-0.7, 0.0, 0.0])),))
    model, data, supply = supplied(propelled, {k: v for k, v in DRIVEN.items() if "stern" in k} | {"water:surface": 0})
    state = np.array([0, 0, -5, 1, 0, 0, 0, 1.0, 0, 0, 0, 0, 0], dtype=float)

    def power(height=-5.0):
        state[2] = height
        set_state(data, state)
        data.act[:] = 0.7
        mujoco.mj_forward(model, data)
        supply.update(data)
        return supply.power[0]

    whole = power()
    assert whole == pytest.approx(drawn(propelled, state, (0.7,))[0])
    faults.set_efficiency(model, "stern", 0.4)
    assert power() == whole
    faults.set_efficiency(model, "stern", 0.0)
    assert power() == 0.0
    faults.set_efficiency(model, "stern", 1.0)
    assert power(0.0) == pytest.approx(0.5 * whole)
    assert power(0.1) == 0.0
    force, u_a = 12.0, 0.944
    faults.set_stuck(model, "stern", force)
    n = brentq(lambda n: 0.9 * STERN.open_water(n, u_a)[0] - force, 1.0, 60.0, xtol=1e-13)
    assert power() == pytest.approx(STERN.open_water(n, u_a)[1] * 2 * np.pi * n / ETA, rel=1e-9)


def test_the_law_compiled_and_not():
    plain, rng = plain_callbacks.plain("cube_sim.vehicle.laws.propeller_power"), np.random.default_rng(1)
    for motor in ({}, {"stern:propeller_motor": (0.06, 0.5), "stern:propeller_shaft": (4e-4, 0.02, 2e-4)}):
        given = {"stern:thruster_voltage": VOLTS} | (motor or {"stern:propeller_efficiency": ETA})
        spec = Propelled(HULL, (STERN,)).spec()
        if motor:
            spec.delete(next(n for n in spec.numerics if n.name == "stern:propeller_speed"))
            spec.delete(next(n for n in spec.numerics if n.name == "stern:propeller_slowest"))
        table = cube_sim.Vehicle.from_model(cube_sim.load_model(spec, given)).thrusters.propellers
        for _ in range(100):
            n, u_a, volts, wet, force = rng.uniform((-25, -2, -VOLTS, 0, -20), (25, 2, VOLTS, 1, 60)).tolist()
            for name, arguments in (("power_of_rotation", (n, u_a, volts, wet)), ("power_of_force", (force, u_a, wet))):
                told = [getattr(each, name)(table.rows[0], table.points, *arguments) for each in (law, plain)]
                assert told[0] == pytest.approx(told[1], rel=1e-12)
                assert told[0] >= 0.0


def test_a_thruster_that_says_it_is_asked_for_its_power_at_rest():
    thrusters = cube_sim.Vehicle.from_model(cube_sim.load_model(Propelled(HULL, (STERN,)).spec(), {
        "stern:propeller_efficiency": ETA, "stern:thruster_voltage": VOLTS})).thrusters  # fmt: skip
    force = 0.9 * STERN.open_water(20.0, 0.0)[0]
    expected = STERN.open_water(20.0, 0.0)[1] * 2 * np.pi * 20.0 / ETA
    assert thrusters.power([force])[0] == pytest.approx(expected, rel=1e-12)
    assert thrusters.power([[0.0], [force]]).ravel() == pytest.approx([0.0, expected])
    battery = drafted_battery(thrusters, 20.0, 25.0)
    full = STERN.open_water(25.0, 0.0)[1] * 2 * np.pi * 25.0 / ETA
    assert float(battery["capacity_Wh"].split()[0]) == pytest.approx(full * 8.0 / 60.0, rel=5e-3)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"stern:propeller_efficiency": 0.0}, "is 0; above 0 and at most 1 is right, for example 0.7"),
        ({"stern:propeller_efficiency": 70.0}, "is 70; above 0 and at most 1 is right"),
        ({"stern:propeller_efficiency": 0.7, "stern:thruster_power": (1.0, 1.0)}, "stands beside stern:propeller_eff"),
        ({"stern:propeller_efficency": 0.7}, "did you mean propeller_efficiency"),
    ],
)
def test_what_makes_no_sense_is_refused(parameters, told):
    with pytest.raises(ModelError, match=told):
        cube_sim.load_model(Propelled(HULL, (STERN,)).spec(), parameters)


def test_a_battery_asks_for_the_efficiency():
    model = cube_sim.load_model(Propelled(HULL, (STERN,)).spec(), {"stern:thruster_voltage": VOLTS})
    with pytest.raises(ModelError, match="stern:propeller_efficiency: is not known, so nobody can tell what it draws"):
        PowerSupply(model, cube_sim.Vehicle.from_model(model).thrusters, Battery(25.0, 0.1))
