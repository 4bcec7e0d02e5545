"""The thruster's curve: forwards, backwards, and as MuJoCo runs it."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.places import CUBE

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.pulse import PulseRange

ZONES = [(0.0, 0.0), (-0.356, 0.4), (-2.0, 2.0), (-12.0, 7.0), (-0.0, 5.0)]


def t200(zone=(-0.356, 0.4)) -> Characteristic:
    model = cube_sim.load_model(CUBE, {"hull:thruster_dead_zone": zone})
    return cube_sim.Vehicle.from_model(model).thrusters.characteristics[0]


@pytest.mark.parametrize("zone", ZONES)
def test_round_trip_of_every_attainable_force(zone):
    curve = t200(zone)
    low, dead_low, dead_high, high = curve.limits
    attainable = np.concatenate([np.linspace(low, dead_low, 301), [0.0], np.linspace(dead_high, high, 301)])
    returned = np.array([float(curve.force(curve.command(f))) for f in attainable.tolist()])
    np.testing.assert_allclose(returned, attainable, atol=1e-9)
    edges = [dead_low, dead_high]
    assert [np.sign(curve.force(curve.command(f))) for f in edges] == [np.sign(f) for f in edges]


@pytest.mark.parametrize("zone", ZONES)
def test_forces_nobody_can_hold_go_to_the_nearest_one(zone):
    curve = t200(zone)
    low, dead_low, dead_high, high = curve.limits
    allowed = np.array([dead_low, 0.0, dead_high])
    for f in np.linspace(dead_low, dead_high, 57)[1:-1]:
        got = float(curve.force(curve.command(float(f))))
        assert abs(got - f) <= np.abs(allowed - f).min() + 1e-9
    assert curve.force(curve.command(1e6)) == high
    assert curve.force(curve.command(-1e6)) == low


@pytest.mark.parametrize("zone", ZONES)
def test_dead_zone_is_silent_and_saturation_flat(zone):
    curve = t200(zone)
    low, high = curve.command_dead_zone
    assert np.all(curve.force(np.linspace(low, high, 101)) == 0.0)
    assert curve.force(high + 1e-9) >= zone[1] - 1e-12
    assert curve.force(low - 1e-9) <= zone[0] + 1e-12
    np.testing.assert_array_equal(curve.force([-3.0, 3.0]), [-39.91, 51.44])
    commands = np.linspace(-1.2, 1.2, 997)
    assert np.all(np.diff(curve.force(commands)) >= 0.0)


def test_measured_points_are_on_the_curve():
    curve = t200()
    assert float(curve.force(0.25)) == pytest.approx(5.92)  # 1600 us
    assert float(curve.force(-0.5)) == pytest.approx(-14.10)  # 1300 us
    assert np.all(curve.force([-0.07, 0.0, 0.07]) == 0.0)  # 1472 .. 1528 us


@pytest.mark.parametrize("zone", ZONES)
def test_mujoco_runs_the_very_curve(zone):
    """Bitwise up to rounding, on both sides of every edge."""
    model = cube_sim.load_model(CUBE, {"hull:thruster_dead_zone": zone})
    curve = cube_sim.Vehicle.from_model(model).thrusters.characteristics[0]
    data = mujoco.MjData(model)
    low, high = curve.command_dead_zone
    commands = np.concatenate([np.linspace(-1.3, 1.3, 203), *[np.nextafter(c, [-9.0, c, 9.0]) for c in (low, high)]])
    for command in commands:
        data.act[:] = command
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(data.actuator_force, curve.force(command), atol=1e-12)


def test_lag_is_first_order():
    """Command step through a 20 ms lag: act = c (1 - exp(-t/tau)), to the order of RK4."""
    model = cube_sim.load_model(CUBE)
    model.opt.timestep = 0.001
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.5
    mujoco.mj_step(model, data, nstep=20)
    np.testing.assert_allclose(data.act, 0.5 * (1.0 - np.exp(-1.0)), atol=1e-8)


def test_a_thruster_of_its_own_goes_before_its_hulls():
    model = cube_sim.load_model(CUBE, {"T3:thruster_dead_zone": (-5.0, 6.0)})
    limits = cube_sim.Vehicle.from_model(model).thrusters.limits
    np.testing.assert_array_equal(limits[2], [-39.91, -5.0, 6.0, 51.44])
    np.testing.assert_array_equal(limits[3], [-39.91, -0.356, 0.4, 51.44])


T200_US = [
    (1100, -39.91), (1140, -35.85), (1180, -29.36), (1220, -24.07), (1260, -19.04), (1300, -14.10), (1340, -10.01),
    (1380, -6.36), (1420, -3.16), (1468, -0.356), (1472, 0.0), (1528, 0.0), (1532, 0.400), (1560, 2.135),
    (1600, 5.92), (1640, 10.14), (1680, 15.08), (1720, 20.82), (1760, 27.05), (1800, 33.54), (1840, 41.72),
    (1880, 49.15), (1900, 51.44),
]  # fmt: skip
"""Pulse [us] and thrust [N] of a T200 at 16 V, rows of the public performance workbook."""


@pytest.mark.parametrize("model", ["cube", "cube_as_built", "bluerov2_heavy"])
def test_the_t200s_table_in_microseconds(model):
    thrusters = cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE.with_stem(model))).thrusters
    edges = (1468, 1532)  # the smallest forces: the motor holds them just beyond, and rests on the edge itself
    for pulse, force in T200_US:
        if force:
            sent = thrusters.pwm([force] * 8)
            np.testing.assert_allclose(sent, pulse, rtol=1e-14)
            np.testing.assert_allclose(thrusters.force_of_pwm(sent), force, rtol=1e-12)
        if pulse not in edges:
            np.testing.assert_allclose(thrusters.force_of_pwm([pulse] * 8), force, atol=1e-12)
        np.testing.assert_allclose(thrusters.command_of_pwm([pulse] * 8), (pulse - 1500) / 400, atol=1e-15)
    assert np.all(thrusters.force_of_pwm([1468, 1532] * 4) == 0.0)
    np.testing.assert_array_equal(thrusters.pwm(np.zeros(8)), 1500.0)
    np.testing.assert_array_equal(thrusters.force_of_pwm([900.0, 2200.0] * 4), [-39.91, 51.44] * 4)
    np.testing.assert_array_equal(thrusters.voltage, 16.0)


@pytest.mark.parametrize("zone", ZONES)
@pytest.mark.parametrize("pulses", [(1100.0, 1500.0, 1900.0), (1900.0, 1500.0, 1100.0), (1000.0, 1487.3, 2012.9)])
def test_round_trip_through_pulses_of_every_attainable_force(zone, pulses):
    """Also for a controller wired the other way round, and for one whose rest is not in the middle."""
    model = cube_sim.load_model(CUBE, {"hull:thruster_dead_zone": zone, "hull:thruster_pwm": pulses})
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    low, dead_low, dead_high, high = thrusters.limits[0]
    attainable = np.concatenate([np.linspace(low, dead_low, 60), np.zeros(8), np.linspace(dead_high, high, 60)])
    for forces in attainable.reshape(-1, 8):
        np.testing.assert_allclose(thrusters.force_of_pwm(thrusters.pwm(forces)), forces, atol=1e-9)
    commands = np.linspace(-1.0, 1.0, 8)
    np.testing.assert_allclose(thrusters.command_of_pwm(thrusters.pwm_of_command(commands)), commands, atol=1e-15)
    forward = np.diff(thrusters.pwm_of_command(commands))
    assert np.all(forward * np.sign(pulses[2] - pulses[0]) > 0.0)


def test_pulses_of_one_thruster_of_its_own_and_of_none():
    model = cube_sim.load_model(CUBE, {"T3:thruster_pwm": (1000, 1500, 2000)})
    ranges = cube_sim.Vehicle.from_model(model).thrusters.pulse_ranges
    assert ranges[2] == PulseRange(1000.0, 1500.0, 2000.0)
    assert ranges[3] == PulseRange(1100.0, 1500.0, 1900.0)
    jack = cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE.with_stem("jack"))).thrusters
    assert np.all(np.isnan(jack.voltage))
    with pytest.raises(ModelError, match=r"T1:thruster_pwm: is not in the model"):
        jack.pwm(np.zeros(4))
