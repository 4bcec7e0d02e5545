"""Thrusters on a bad day: faults and supply on a compiled model, delay, reaction torque, power."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.edited_cube import T1, edited
from support.places import CUBE
from support.vehicles import vehicle

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle import faults
from cube_sim.vehicle.characteristic import Characteristic


@pytest.fixture
def model():
    return cube_sim.load_model(CUBE)


def forces(model, command: float) -> np.ndarray:
    data = mujoco.MjData(model)
    data.act[:] = command
    mujoco.mj_forward(model, data)
    return np.array(data.actuator_force)


def test_health_scales_one_thruster(model):
    whole = forces(model, 0.6)
    faults.set_efficiency(model, "T3", 0.4)
    faults.set_efficiency(model, "T5", 0.0)
    expected = whole.copy()
    expected[2] *= 0.4
    expected[4] = 0.0
    np.testing.assert_allclose(forces(model, 0.6), expected, rtol=1e-15)
    faults.set_efficiency(model, "T3", 1.0)
    faults.set_efficiency(model, "T5", 1.0)
    np.testing.assert_array_equal(forces(model, 0.6), whole)


def test_a_stuck_thruster_ignores_its_command(model):
    faults.set_stuck(model, "T2", -12.5)
    for command in (-1.0, 0.0, 0.7):
        assert forces(model, command)[1] == -12.5
    faults.set_efficiency(model, "T2", 1.0)
    assert forces(model, 0.0)[1] == 0.0


def test_supply_scales_with_its_square(model):
    whole = forces(model, 0.8)
    faults.set_supply(model, "T1", 12.0 / 16.0)
    assert forces(model, 0.8)[0] == pytest.approx(whole[0] * 0.5625, rel=1e-14)


def test_supply_scales_a_stuck_thruster_too(model):
    faults.set_stuck(model, "T2", -12.0)
    faults.set_supply(model, "T2", 0.5)
    assert forces(model, 0.8)[1] == -3.0
    faults.set_supply(model, "T2", 0.0)
    assert forces(model, 0.8)[1] == 0.0


def test_a_copy_has_its_own_faults(model):
    import copy

    other = copy.copy(model)
    faults.set_efficiency(other, "T1", 0.0)
    assert forces(model, 1.0)[0] == 51.44
    assert forces(other, 1.0)[0] == 0.0


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda m: faults.set_efficiency(m, "T9", 1.0), "is no thruster; the model has T1, T2"),
        (lambda m: faults.set_efficiency(m, "T1", 1.1), "efficiency 1.1 is outside"),
        (lambda m: faults.set_efficiency(m, "T1", float("nan")), "efficiency nan is outside"),
        (lambda m: faults.set_stuck(m, "T1", 60.0), "it gives -39.91 to 51.44 N"),
        (lambda m: faults.set_stuck(m, "T1", float("nan")), "cannot be stuck at nan"),
        (lambda m: faults.set_supply(m, "T1", -0.1), "negative or not finite"),
    ],
)
def test_wrong_conditions(model, change, reason):
    with pytest.raises(ModelError) as caught:
        change(model)
    assert reason in str(caught.value)


def test_transport_delay_comes_before_the_lag():
    """MuJoCo's own delay line: the command arrives 50 ms late, then the 20 ms lag follows."""
    model = cube_sim.load_model(edited((T1, f'{T1} delay="0.05" nsample="8"')))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER  # RK4 looks a step ahead, and blurs the delay by a stage
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.5
    history = []
    for _ in range(12):
        mujoco.mj_step(model, data)
        history.append(data.act[:2].copy())
    late, prompt = np.array(history).T
    np.testing.assert_allclose(late[:5], 0.0)
    np.testing.assert_allclose(late[5:], prompt[:7], atol=1e-14)
    assert prompt[0] > 0.1


def test_reaction_torque_is_a_column_of_the_actuation_matrix():
    """gear="0 0 1 0 0 k": a propeller turns the hull against itself with k F about its axis."""
    plain = vehicle("cube").actuation_matrix
    turned = cube_sim.Vehicle.from_model(
        cube_sim.load_model(edited(('<general name="T4"', '<general gear="0 0 1 0 0 0.02" name="T4"')))
    ).actuation_matrix
    expected = plain.copy()
    expected[3:, 3] += 0.02 * plain[:3, 3]
    np.testing.assert_allclose(turned, expected, atol=1e-15)


def test_power_and_energy(model):
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    full = np.zeros(8)
    full[0], full[1] = 51.44, -39.91
    power = thrusters.power(full)
    assert power[0] == pytest.approx(381.0, rel=0.05)  # measured, public workbook
    assert power[1] == pytest.approx(389.0, rel=0.07)
    assert np.all(power[2:] == 0.0)
    time = np.linspace(0.0, 10.0, 11)
    assert thrusters.energy(time, np.tile(full, (11, 1))) == pytest.approx(10.0 * power.sum())


def test_reactivity_points(model):
    """Where the curve is steepest: between 1800 and 1840 us forwards, between 1140 and 1180 us in reverse."""
    curve = cube_sim.Vehicle.from_model(model).thrusters.characteristics[0]
    assert curve.reactivity == pytest.approx((0.5 * (-35.85 - 29.36), 0.5 * (33.54 + 41.72)))
    line = Characteristic(np.array([-1.0, 0.0, 1.0]), np.array([-10.0, 0.0, 20.0]), (-1.0, 1.0))
    assert line.reactivity == (-5.5, 10.5)


def test_reactivity_points_lie_outside_the_dead_zone():
    """Jack's jump from 0 to 5 N is steeper than anything it can hold; its steepest part is 18 to 25 N, 35 N a unit."""
    jack = vehicle("jack").thrusters
    np.testing.assert_allclose(jack.reactivity, [[-21.5, 21.5]] * 4)
    curve = Characteristic(np.array([-1.0, -0.4, 0.0, 0.2, 1.0]), np.array([-10.0, -9.0, 0.0, 8.0, 16.0]), (-6.0, 12.0))
    assert curve.reactivity == pytest.approx(
        (-7.5, 14.0)
    )  # -9 to -6 of the steep segment is left, 12 to 16 of the flat
    full = Characteristic(np.array([-1.0, 0.0, 1.0]), np.array([-10.0, 0.0, 20.0]), (-10.0, 20.0))
    assert full.reactivity == (-10.0, 20.0)
