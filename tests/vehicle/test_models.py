"""Each vehicle in models/ against the table it was made from."""

from __future__ import annotations

import runpy

import mujoco
import numpy as np
import pytest
from support import layouts
from support.places import CUBE, MODELS, REPO
from support.vehicles import vehicle

import cube_sim
from cube_sim.vehicle.infante import planar_lift


def test_cube():
    """Chosen numbers: an edge of 0.5 m in fresh water, thrusters on the vertices of a cube of half edge 0.2 m."""
    L, a, rho = 0.5, 0.2, 1000.0
    m = rho * L**3
    model = cube_sim.load_model(CUBE)
    cube = cube_sim.Vehicle.from_model(model)
    np.testing.assert_allclose(cube.mass_matrix, np.diag([m] * 3 + [m * L**2 / 6] * 3), rtol=1e-12, atol=1e-12)
    added = [0.6384 * rho * L**3] * 3 + [0.03926 * rho * L**5] * 3
    np.testing.assert_allclose(cube.added_mass, np.diag(added), rtol=1e-12)
    np.testing.assert_allclose(cube.linear_damping, np.diag([5.0] * 3 + [0.5] * 3))
    np.testing.assert_allclose(cube.quadratic_damping, np.diag([0.5 * rho * 1.05 * L**2] * 3 + [1.0] * 3))
    assert cube.displaced_mass == m
    np.testing.assert_allclose(cube.centre_of_buoyancy, [0.0, 0.0, 0.02])
    np.testing.assert_allclose(cube.centre_of_mass, 0.0, atol=1e-15)
    assert model.opt.timestep == 0.01
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4

    A = cube.actuation_matrix
    np.testing.assert_allclose(A, layouts.cube(a), atol=1e-15)
    np.testing.assert_allclose(A @ A.T, np.diag([8 / 3] * 3 + [8 * a**2] * 3), atol=1e-14)
    np.testing.assert_allclose(A @ [1, -1, 1, -1, -1, 1, -1, 1], 0.0, atol=1e-14)
    assert cube.thrusters.names == tuple(f"T{i}" for i in range(1, 9))
    np.testing.assert_allclose(cube.thrusters.limits, [[-39.91, -0.356, 0.4, 51.44]] * 8)
    np.testing.assert_allclose(cube.thrusters.lag_s, 0.02)


def test_the_cubes_added_mass_is_what_panels_say():
    translation, rotation = runpy.run_path(str(REPO / "benchmarks" / "cube_added_mass.py"))["extrapolated"](16)
    assert translation == pytest.approx(0.6384, rel=2e-3)
    assert rotation == pytest.approx(0.03926, rel=4e-3)


def test_cube_thrust_is_the_actuation_matrix():
    """F_B = A F_m in any attitude: the wrench read from qfrc_actuator."""
    model = cube_sim.load_model(CUBE)
    cube = cube_sim.Vehicle.from_model(model)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    for _ in range(10):
        q = rng.normal(size=4)
        data.qpos[3:7] = q / np.linalg.norm(q)
        data.act[:] = rng.uniform(-1.0, 1.0, 8)
        mujoco.mj_forward(model, data)
        R = data.xmat[cube.body].reshape(3, 3)
        wrench = np.concatenate([R.T @ data.qfrc_actuator[:3], data.qfrc_actuator[3:]])
        np.testing.assert_allclose(wrench, cube.actuation_matrix @ cube.thrusters.force(data.act), atol=1e-12)


def planar(matrix: np.ndarray) -> np.ndarray:
    """Rows surge, sway, yaw."""
    return matrix[[0, 1, 5]]


def test_cube_as_built_is_the_cube_with_imprecise_thrusters():
    cube = vehicle("cube")
    built = vehicle("cube_as_built")
    rng = np.random.default_rng(2021)
    gain, shift = 1.0 + 0.05 * rng.standard_normal(8), 0.01 * rng.standard_normal((8, 3))
    expected = cube.actuation_matrix.copy()
    for i in range(8):
        expected[3:, i] += np.cross(shift[i], expected[:3, i])
        expected[:, i] *= gain[i]
    np.testing.assert_allclose(built.actuation_matrix, expected, atol=2e-6)
    assert np.abs(built.actuation_matrix - cube.actuation_matrix).max() > 0.02
    for name in ("mass_matrix", "added_mass", "linear_damping", "quadratic_damping", "centre_of_buoyancy"):
        np.testing.assert_array_equal(getattr(built, name), getattr(cube, name))
    np.testing.assert_array_equal(built.thrusters.limits, cube.thrusters.limits)


FLIP = np.diag([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])  # FRD to FLU: y and z change sign


def test_bluerov2_heavy_is_its_table():
    """Von Benzon et al. 2022, table A1 and the allocation matrix, as published in FRD."""
    rov = vehicle("bluerov2_heavy")
    h = np.sqrt(0.5)
    published = np.array(
        [
            [h, h, -h, -h, 0, 0, 0, 0],
            [-h, h, -h, h, 0, 0, 0, 0],
            [0, 0, 0, 0, -1, 1, 1, -1],
            [0.0601, -0.0601, 0.0601, -0.0601, -0.218, -0.218, 0.218, 0.218],
            [0.0601, 0.0601, -0.0601, -0.0601, 0.12, -0.12, 0.12, -0.12],
            [-0.1888, 0.1888, 0.1888, -0.1888, 0, 0, 0, 0],
        ]
    )
    np.testing.assert_allclose(rov.actuation_matrix, FLIP @ published, atol=6e-5)
    np.testing.assert_allclose(rov.mass_matrix, np.diag([13.5, 13.5, 13.5, 0.26, 0.23, 0.37]), atol=1e-12)
    np.testing.assert_allclose(rov.added_mass, np.diag([6.36, 7.12, 18.68, 0.189, 0.135, 0.222]))
    np.testing.assert_allclose(rov.linear_damping, np.diag([13.7, 0, 33, 0, 0.8, 0]))
    np.testing.assert_allclose(rov.quadratic_damping, np.diag([141, 217, 190, 1.19, 0.47, 1.5]))
    np.testing.assert_allclose(rov.centre_of_buoyancy, [0.0, 0.0, 0.01])
    assert rov.displaced_mass == pytest.approx(13.4)


@pytest.mark.parametrize(("axis", "force", "speed"), [(0, 85.0, 0.72), (1, 85.0, 0.63), (2, 120.0, 0.71)])
def test_bluerov2_heavy_reaches_its_published_top_speeds(axis, force, speed):
    """Pushed along one axis through the centre, and weighing nothing in the water: kept straight, as a pilot would."""
    model = cube_sim.load_model(MODELS / "bluerov2_heavy.xml", {"hull:volume": 0.0135})
    data = mujoco.MjData(model)
    for _ in range(600):
        R = data.xmat[1].reshape(3, 3) if data.time else np.eye(3)
        data.qfrc_applied[:3] = R[:, axis] * force
        mujoco.mj_step(model, data)
    v = data.xmat[1].reshape(3, 3).T @ data.qvel[:3]
    assert v[axis] == pytest.approx(speed, rel=0.03)


def test_bluerov2_heavy_does_not_keep_straight_by_itself():
    """Its thrusters make surge and no moment: below 0.33 m/s it stays level, at its top speed it turns over."""
    model = cube_sim.load_model(MODELS / "bluerov2_heavy.xml")
    rov = cube_sim.Vehicle.from_model(model)
    m_u, m_w = rov.added_mass[0, 0], rov.added_mass[2, 2]
    limit = np.sqrt(rov.displaced_mass * 9.81 * rov.centre_of_buoyancy[2] / (m_w - m_u))
    assert limit == pytest.approx(0.33, abs=0.005)
    for surge, slow in ((12.0, True), (85.0, False)):
        data = mujoco.MjData(model)
        data.ctrl[:] = rov.thrusters.command(np.linalg.pinv(rov.actuation_matrix) @ [surge, 0, 0, 0, 0, 0])
        pitch, speed = 0.0, 0.0
        for _ in range(6000):
            mujoco.mj_step(model, data)
            pitch = max(pitch, abs(np.degrees(np.arcsin(data.xmat[1, 6]))))
            speed = max(speed, data.xmat[1].reshape(3, 3)[:, 0] @ data.qvel[:3])
        assert bool(speed < limit) is slow
        assert pitch < 5.0 if slow else pitch == pytest.approx(78.8, abs=2.0)


def test_infante_feeds_energy_in_astern():
    """The published products of velocities, as its file says: for motion ahead only."""
    for u, v, r, expected in ((1.0, 0.0, 0.1, -14.3), (-1.0, 0.0, 0.1, 14.3), (-1.0, 0.1, 0.0, 3.5)):
        nu = np.array([u, v, 0.0, 0.0, 0.0, r])
        assert np.dot(planar_lift(0.0, np.zeros(3), np.eye(3), nu, nu), nu) == pytest.approx(expected, abs=0.05)


def test_jack_is_its_matrix():
    jack = vehicle("jack")
    np.testing.assert_allclose(planar(jack.actuation_matrix), layouts.jack(), atol=5e-4)
    np.testing.assert_allclose(jack.actuation_matrix[2:5], 0.0, atol=1e-15)
    np.testing.assert_allclose(jack.actuation_matrix @ np.ones(4), 0.0, atol=1e-15)
    m, (a, b, c) = 40.0, (0.6, 0.6, 0.2)
    inertia = m / 12.0 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    np.testing.assert_allclose(jack.mass_matrix, np.diag([m, m, m, *inertia]), atol=1e-12)
    assert jack.displaced_mass == m
    np.testing.assert_allclose(jack.thrusters.limits, [[-25.0, -5.0, 5.0, 25.0]] * 4)


def test_infante_obeys_its_published_planar_equations():
    """Accelerations of the compiled model at random planar states and thrusts, against the literature's equations."""
    Xudot, Yvdot, Nrdot, Xuu, Yuv, Yvv, Yur = -141.9, -1715.4, -1349.0, -35.4, -346.76, -667.5, 103.4
    Nuv, Nvv, Nur, Nrr, m, Iz = -686.08, 433.8, -1427.0, -310.0, 2234.5, 2000.0
    m_u, m_v, m_r, m_ur = m - Xudot, m - Yvdot, Iz - Nrdot, m - Yur
    assert (m_u, m_v, m_r, m_ur) == pytest.approx((2376.4, 3949.9, 3349.0, 2131.1))
    model = cube_sim.load_model(MODELS / "infante.xml")
    infante = cube_sim.Vehicle.from_model(model)
    np.testing.assert_allclose(planar(infante.actuation_matrix), [[1, 1], [0, 0], [-0.6, 0.6]], atol=1e-15)
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    for _ in range(50):
        u, v, r = rng.uniform(-2.0, 2.0), rng.uniform(-0.8, 0.8), rng.uniform(-0.4, 0.4)
        yaw = rng.uniform(-3.0, 3.0)
        data.qpos[3:7] = np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
        mujoco.mj_kinematics(model, data)
        R = data.xmat[1].reshape(3, 3)
        data.qvel[:] = [*(R @ [u, v, 0.0]), 0.0, 0.0, r]
        data.act[:] = rng.uniform(-1.0, 1.0, 2)
        mujoco.mj_forward(model, data)
        F, _, gamma = planar(infante.actuation_matrix) @ data.actuator_force
        d_u, d_v = -Xuu * u * abs(u), -Yuv * u * v - Yvv * v * abs(v)
        d_r = -Nuv * u * v - Nvv * v * abs(v) - Nur * u * r - Nrr * r * abs(r)
        expected = [(F - d_u) / m_u, (-m_ur * u * r - d_v) / m_v, (gamma - d_r) / m_r]
        body_acceleration = R.T @ data.qacc[:3] - np.cross([0.0, 0.0, r], [u, v, 0.0])
        np.testing.assert_allclose([*body_acceleration[:2], data.qacc[5]], expected, atol=1e-12)
        np.testing.assert_allclose([body_acceleration[2], data.qacc[3], data.qacc[4]], 0.0, atol=1e-12)
