"""A battery under eight propellers: sag, energy and charge against closed forms."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.places import CUBE

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle import faults
from cube_sim.vehicle.battery import Battery
from cube_sim.vehicle.power_supply import PowerSupply

FULL_AHEAD_W = 8 * 0.997 * 51.44**1.5  # of eight T200 at 16 V, by the fit in the model


@pytest.fixture
def cube():
    model = cube_sim.load_model(CUBE)
    return model, mujoco.MjData(model), cube_sim.Vehicle.from_model(model).thrusters


def ahead(data: mujoco.MjData, model: mujoco.MjModel, command: float = 1.0) -> None:
    data.act[:] = data.ctrl[:] = command
    mujoco.mj_forward(model, data)


@pytest.mark.parametrize("load", [0.0, 1e-9, 0.1, 3.0, 1e4])
@pytest.mark.parametrize("charge", [0.0, 0.3, 1.0])
def test_ohms_law_at_any_load(load, charge):
    battery = Battery(open_voltage=16.8, resistance=0.05, empty_voltage=12.8)
    voltage = battery.voltage(load, charge)
    current = load * voltage**2
    assert voltage == pytest.approx(12.8 + 4.0 * charge - 0.05 * current, rel=1e-12)
    assert 0.0 < voltage <= 16.8
    drain = battery.drain(current * voltage, voltage)
    assert drain == pytest.approx(battery.open_voltage_at(charge) * current, rel=1e-9)


def test_without_resistance_and_limits_it_is_a_constant_voltage():
    assert Battery(16.0, 0.0).voltage(1e4, 0.2) == 16.0


@pytest.mark.parametrize("resistance", [0.02, 0.1, 0.5])
def test_one_update_finds_voltage_forces_and_power_that_fit(cube, resistance):
    """Also where the sag is so deep that a voltage one step late would swing for ever (V below 0.8 E)."""
    model, data, thrusters = cube
    ahead(data, model)
    whole, seen = data.actuator_force.copy(), []
    supply = PowerSupply(model, thrusters, Battery(16.8, resistance))
    ahead(data, model)
    np.testing.assert_allclose(data.actuator_force, whole * (16.8 / 16.0) ** 2, rtol=1e-13)  # nothing drawn yet
    for _ in range(3):
        supply.update(data)
        seen.append(supply.voltage)
    voltage = supply.voltage
    np.testing.assert_allclose(seen, voltage, rtol=1e-13)
    np.testing.assert_allclose(data.actuator_force, whole * (voltage / 16.0) ** 2, rtol=1e-13)
    np.testing.assert_allclose(supply.power, thrusters.power(data.actuator_force), rtol=1e-14)
    assert supply.power.sum() == pytest.approx(FULL_AHEAD_W * (voltage / 16.0) ** 3, rel=1e-12)
    assert voltage == pytest.approx(16.8 - resistance * supply.power.sum() / voltage, rel=1e-12)
    assert supply.force_ratio == pytest.approx((voltage / 16.0) ** 2, rel=1e-15)
    assert (voltage < 0.8 * 16.8) == (resistance > 0.05)


def test_sag_takes_account_of_faults(cube):
    model, data, thrusters = cube
    faults.set_efficiency(model, "T1", 0.5)
    faults.set_efficiency(model, "T2", 0.0)
    faults.set_stuck(model, "T3", -20.0)
    supply = PowerSupply(model, thrusters, Battery(16.0, 0.1))
    ahead(data, model)
    supply.update(data)
    s = supply.force_ratio
    np.testing.assert_allclose(data.actuator_force, s * np.array([25.72, 0.0, -20.0] + [51.44] * 5), rtol=1e-12)
    assert supply.voltage == pytest.approx(16.0 - 0.1 * supply.power.sum() / supply.voltage, rel=1e-12)


def test_energy_is_the_integral_of_power(cube):
    """Commands that come and go, without a battery: trapezoidal rule, and the analysis' own sum."""
    model, data, thrusters = cube
    supply = PowerSupply(model, thrusters)
    times, forces = [], []
    for k in range(200):
        data.ctrl[:] = 0.6 * np.sin(0.1 * k + np.arange(8))
        mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        supply.update(data)
        times.append(data.time)
        forces.append(data.actuator_force.copy())
        assert (supply.voltage, supply.force_ratio, supply.charge) == (16.0, 1.0, 1.0)
    assert supply.energy == pytest.approx(thrusters.energy(times, forces), rel=1e-12)
    assert supply.energy > 100.0
    np.testing.assert_allclose(supply.power, thrusters.power(forces[-1]), rtol=1e-14)


def test_discharge_follows_its_differential_equation(cube):
    """Full ahead from a small battery: q' = -E(q) k V(q)^2 / capacity, integrated by other means; then it is empty."""
    model, data, thrusters = cube
    battery = Battery(open_voltage=16.8, resistance=0.02, empty_voltage=12.8, capacity=20e3)
    supply, k = PowerSupply(model, thrusters, battery, charge=0.9), FULL_AHEAD_W / 16.0**3

    def rate(_, q):
        E = 12.8 + 4.0 * q[0]
        V = 2.0 * E / (1.0 + np.sqrt(1.0 + 4.0 * 0.02 * k * E))
        return [-E * k * V**2 / 20e3]

    def empty(_, q):
        return q[0]

    empty.terminal = True
    exact = solve_ivp(rate, (0.0, 60.0), [0.9], rtol=1e-10, atol=1e-12, events=empty, dense_output=True)
    end = float(exact.t_events[0][0])
    dt, emptied = 0.01, []
    for step in range(round(1.2 * end / dt)):
        data.time = step * dt
        ahead(data, model)
        if supply.update(data):
            emptied.append(data.time)
        if step % 50 == 0 and data.time < end - 0.1:
            assert supply.charge == pytest.approx(exact.sol(data.time)[0], abs=2e-4)
    assert emptied == [pytest.approx(end, abs=0.02)]
    assert (supply.charge, supply.voltage, supply.force_ratio) == (0.0, 0.0, 0.0)
    assert np.all(data.actuator_force == 0.0)
    assert supply.power.sum() == 0.0
    assert 0.7 * 0.9 * 20e3 < supply.energy < 0.9 * 20e3  # the rest became heat in the cells


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"T3:thruster_voltage": 12.0}, "differs among the thrusters of one battery: T1 16 V, T2 16 V, T3 12 V"),
        ({"T3:thruster_power": (0.0, 1.0)}, "T3:thruster_power: is not known"),
    ],
)
def test_thrusters_a_battery_cannot_feed(changes, reason):
    model = cube_sim.load_model(CUBE, changes)
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    with pytest.raises(ModelError, match=reason):
        PowerSupply(model, thrusters, Battery(16.0, 0.1))
    assert PowerSupply(model, thrusters).voltage == (16.0 if "T3:thruster_power" in changes else 0.0)


def test_thrusters_that_do_not_say_their_voltage():
    model = cube_sim.load_model(CUBE.with_stem("jack"))
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    with pytest.raises(ModelError, match="T1:thruster_voltage: is not in the model"):
        PowerSupply(model, thrusters, Battery(16.0, 0.1))


def test_a_damaged_propeller_draws_what_a_healthy_one_does_and_a_dead_thruster_nothing():
    """At the same command: half the thrust is the propeller's loss, not the motor's rest."""
    model = cube_sim.load_model(CUBE)
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    faults.set_efficiency(model, "T1", 0.5)
    faults.set_efficiency(model, "T2", 0.0)
    faults.set_efficiency(model, "T3", 0.3)
    faults.set_stuck(model, "T3", -20.0)
    data = mujoco.MjData(model)
    data.act[:] = [1.0, 1.0, 1.0, 1.0, -1.0, 0.0, 0.5, 0.5]
    mujoco.mj_forward(model, data)
    supply = PowerSupply(model, thrusters)
    supply.update(data)
    assert data.actuator_force[0] == pytest.approx(0.5 * 51.44)
    k_reverse, k_forward = thrusters.power_coefficients[0]
    whole = k_forward * 51.44**1.5
    np.testing.assert_allclose(
        supply.power[:6], [whole, 0.0, k_reverse * 20.0**1.5, whole, k_reverse * 39.91**1.5, 0.0], rtol=1e-12
    )
