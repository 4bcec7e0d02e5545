"""The thruster's curve: forwards, backwards, and as MuJoCo runs it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import cube_sim
from cube_sim.vehicle.characteristic import Characteristic

CUBE = Path(__file__).parents[1] / "models" / "cube.xml"
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
