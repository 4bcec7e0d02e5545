"""The vehicles of the catalogue are sound, and those that are slightly wrong are wrong in that one thing."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from support.catalogue import wrong
from support.catalogue.drawn import LEAST, MOST, drawn_layout
from support.catalogue.known import known_layouts
from support.catalogue.mjcf import T200, box_hull, mjcf
from support.catalogue.vehicles import catalogue

from cube_sim import Vehicle, load_model

WHOLE = [name for name, entry in catalogue().items() if not entry.lost]


def loaded(text, tmp_path):
    (tmp_path / "model.xml").write_text(text)
    return Vehicle.from_model(load_model(tmp_path / "model.xml"))


def text_of(name):
    return catalogue()[name].make()


def test_there_are_forty_layouts_at_least_of_three_to_eight_thrusters():
    assert len(WHOLE) >= 40
    drawn = {len(drawn_layout(seed, m).thrusters) for m in range(LEAST, MOST + 1) for seed in range(4)}
    assert drawn == set(range(3, 9))
    assert sum(bool(entry.lost) for entry in catalogue().values()) >= 10


@pytest.mark.parametrize("name", WHOLE)
def test_a_vehicle_floats_upright_at_its_depth(name, tmp_path):
    hull = loaded(text_of(name), tmp_path).dynamics
    weight = hull.mass_matrix[0, 0]
    share = 0.01 if name in ("rov6", "bluerov2_heavy", "bluerov2_standard") else 1e-9  # as published
    assert abs(hull.displaced_mass - weight) <= share * weight
    assert hull.centre_of_buoyancy[2] > hull.centre_of_mass[2]
    assert np.linalg.eigvalsh(hull.mass_matrix + hull.added_mass).min() > 0.0


@pytest.mark.parametrize("name", [name for name, entry in catalogue().items() if entry.lost])
def test_what_is_lost_is_there(name, tmp_path):
    entry = catalogue()[name]
    assert set(entry.lost) < set(loaded(entry.make(), tmp_path).thrusters.names)


@pytest.mark.parametrize("m", range(LEAST, MOST + 1))
def test_a_drawn_layout_is_the_same_again_and_another_for_another_seed(m):
    first, again, other = (mjcf("x", drawn_layout(seed, m)) for seed in (5, 5, 6))
    assert first == again != other


def test_a_layout_is_written_as_its_table_says(tmp_path):
    layout = known_layouts()["torpedo_fins"]
    vehicle = loaded(mjcf("x", layout), tmp_path)
    for column, thruster in zip(vehicle.actuation_matrix.T, layout.thrusters, strict=True):
        u = np.asarray(thruster.axis) / np.linalg.norm(thruster.axis)
        np.testing.assert_allclose(column[:3], u, atol=1e-12)
        np.testing.assert_allclose(column[3:], np.cross(thruster.position, u) + thruster.reaction_m * u, atol=1e-12)
    shares = [thruster.share for thruster in layout.thrusters]
    np.testing.assert_allclose(vehicle.thrusters.limits[:, 3], layout.thrust * np.array(shares))
    assert T200[-1][1] / T200[0][1] == pytest.approx(vehicle.thrusters.limits[0, 3] / vehicle.thrusters.limits[0, 0])


def test_a_box_turns_against_what_its_faces_would_feel():
    """The torque of 1/2 rho C |u| u over both halves of a thin plate that turns about its middle, integrated."""
    hull = box_hull(10.0, (1.0, 1e-9, 0.5), 0.01, drag_coefficient=1.2)
    x = np.linspace(-0.5, 0.5, 20001)
    torque = np.trapezoid(0.5 * 1000.0 * 1.2 * 0.5 * np.abs(x) ** 3, x)
    assert hull.quadratic_damping[5] == pytest.approx(torque, rel=1e-6)


@pytest.mark.parametrize("name", ["cube", "rov6", "bluerov2_heavy", "drawn5_1"])
def test_one_thing_is_wrong_and_the_rest_is_right(name, tmp_path):
    text = text_of(name)
    right = loaded(text, tmp_path)
    A, volume, m = right.actuation_matrix, right.dynamics.displaced_mass, len(right.thrusters.names)

    moved = loaded(wrong.thrusters_moved(text, (0.0, 0.0, 0.03)), tmp_path).actuation_matrix
    np.testing.assert_allclose(moved[:3], A[:3], atol=1e-9)
    np.testing.assert_allclose(moved[3:] - A[3:], np.cross([0.0, 0.0, 0.03], A[:3].T).T, atol=1e-9)

    scattered = [wrong.thrusters_scattered(text, 0.02, seed) for seed in (1, 1, 2)]
    assert scattered[0] == scattered[1] != scattered[2]
    change = np.linalg.norm(loaded(scattered[0], tmp_path).actuation_matrix[3:] - A[3:], axis=0)
    assert 0.0 < change.max() <= 0.02 * (1.0 + 1e-9)

    buoyant = loaded(wrong.buoyancy_moved(text, (0.01, 0.0, 0.0)), tmp_path).dynamics
    shift = buoyant.centre_of_buoyancy - right.dynamics.centre_of_buoyancy
    np.testing.assert_allclose(shift, (0.01, 0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(buoyant.mass_matrix, right.dynamics.mass_matrix)

    assert loaded(wrong.lift_changed(text, -0.02), tmp_path).dynamics.displaced_mass == pytest.approx(0.98 * volume)

    twisted = loaded(wrong.with_reaction(text, -0.01), tmp_path).actuation_matrix
    np.testing.assert_allclose(twisted[3:] - A[3:], -0.01 * A[:3], atol=1e-9)

    names = right.thrusters.names
    weak = loaded(wrong.with_efficiency(text, {names[1]: 0.4}), tmp_path).actuation_matrix
    np.testing.assert_allclose(weak, A * np.where(np.arange(m) == 1, 0.4, 1.0), atol=1e-9)


def test_a_current_is_what_its_rows_say(tmp_path):
    from cube_sim.vehicle.current import water_velocity

    rows = [[t, z, 0.1 * t, 0.01 * z, 0.0] for t in (0.0, 10.0) for z in (-20.0, -10.0)]
    (tmp_path / "model.xml").write_text(wrong.with_current(text_of("cube"), rows))
    model = load_model(tmp_path / "model.xml")
    assert isinstance(model, mujoco.MjModel)
    np.testing.assert_allclose(water_velocity(model, 5.0, -15.0), (0.5, -0.15, 0.0), atol=1e-12)
