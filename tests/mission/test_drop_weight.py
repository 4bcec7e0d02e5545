"""Ballast let go: how hard it lifts, and where the hull comes to rest."""

import mujoco
import numpy as np
import pytest
from support.edited_cube import edited
from support.flights import FORCES_ONLY, thruster_event
from support.places import CUBE, SCENARIOS

import cube_sim
from cube_sim import Vehicle, load_model
from cube_sim.mission.drop_weight import DropWeight
from cube_sim.vehicle.floating import floating_height, water_surface, weighs_less


def test_ballast_goes_once_and_only_where_there_is_some():
    model = load_model(edited())
    vehicle, data = Vehicle.from_model(model), mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ballast = DropWeight(15.0, vehicle)
    ballast.lift(data)
    assert not data.xfrc_applied.any()
    assert ballast.drop()
    assert not ballast.drop()
    ballast.lift(data)
    np.testing.assert_array_equal(data.xfrc_applied[vehicle.body], [0.0, 0.0, 15.0, 0.0, 0.0, 0.0])
    assert not DropWeight(0.0, vehicle).drop()


@pytest.mark.parametrize("weight", [15.0, 400.0, 800.0])
def test_a_lighter_hull_comes_to_rest_at_the_height_it_floats_at(weight):
    model = load_model(CUBE, {"water:surface": 2.0, "hull:linear_damping": [300, 300, 300, 30, 30, 30]})
    vehicle, data = Vehicle.from_model(model), mujoco.MjData(model)
    ballast = DropWeight(weight, vehicle)
    assert ballast.drop()
    for _ in range(5000):
        ballast.lift(data)
        mujoco.mj_step(model, data, nstep=2)
    assert np.abs(data.qvel).max() < 1e-3
    floats_at = water_surface(model) + floating_height(model, vehicle, weight)
    assert data.qpos[2] == pytest.approx(floats_at, abs=1e-3)


def test_a_hull_as_heavy_as_its_water_floats_just_awash():
    """Its ellipsoid is the ball of 0.125 m^3 about the centre of buoyancy, 2 cm above the origin."""
    model = load_model(CUBE)
    vehicle = Vehicle.from_model(model)
    radius = (0.125 * 0.75 / np.pi) ** (1.0 / 3.0)
    assert floating_height(model, vehicle) == pytest.approx(-radius - 0.02)
    assert floating_height(model, vehicle, 0.5 * 125.0 * 9.81) == pytest.approx(-0.02)
    assert not weighs_less(vehicle)
    assert weighs_less(vehicle, 1.0)
    assert water_surface(model) == np.inf


@pytest.mark.flight
def test_a_hull_without_thrusters_rises_no_faster_than_its_drag_allows_and_floats(tmp_path):
    changes = {
        "duration_s": 60,
        "events": [thruster_event(5, [f"T{i}" for i in range(1, 9)])],
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(SCENARIOS / "cube_surface.yaml", changes, out=tmp_path)
    height = run.signals["pose.position"][:, 3]
    terminal = np.roots([131.25, 5.0, -15.0]).max()  # [m/s], 15 N against the CUBE's drag
    assert np.abs(np.gradient(height, 0.02)[500:]).max() <= 1.01 * terminal
    model = load_model(CUBE)
    floats_at = floating_height(model, Vehicle.from_model(model), 15.0)
    assert height[-1] == pytest.approx(floats_at, abs=0.05)
    assert any("comes out of the water" in line.text for line in run.log)
