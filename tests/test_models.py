"""Every vehicle in models/ against the table it was made from."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

import cube_sim

MODELS = Path(__file__).parents[1] / "models"


def test_cube():
    """Chosen numbers: an edge of 0.5 m in fresh water, thrusters on the vertices of a cube of half edge 0.2 m."""
    L, a, rho = 0.5, 0.2, 1000.0
    m = rho * L**3
    model = cube_sim.load_model(MODELS / "cube.xml")
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

    p, q, c = 0.5 + 1 / np.sqrt(12), 0.5 - 1 / np.sqrt(12), 1 / np.sqrt(3)
    columns = []
    for top in (1.0, -1.0):
        r, u = np.array([a, a, top * a]), np.array([q, -p, top * c])
        for _ in range(4):
            columns.append(np.concatenate([u, np.cross(r, u)]))
            turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
            r, u = turn @ r, turn @ u
    A = cube.actuation_matrix
    np.testing.assert_allclose(A, np.array(columns).T, atol=1e-15)
    np.testing.assert_allclose(A @ A.T, np.diag([8 / 3] * 3 + [8 * a**2] * 3), atol=1e-14)
    np.testing.assert_allclose(A @ [1, -1, 1, -1, -1, 1, -1, 1], 0.0, atol=1e-14)
    assert cube.thrusters.names == tuple(f"T{i}" for i in range(1, 9))
    np.testing.assert_allclose(cube.thrusters.limits, [[-39.91, -0.356, 0.4, 51.44]] * 8)
    np.testing.assert_allclose(cube.thrusters.lag_s, 0.02)


def test_cube_thrust_is_the_actuation_matrix():
    """F_B = A F_m in any attitude: the wrench read from qfrc_actuator."""
    model = cube_sim.load_model(MODELS / "cube.xml")
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
