"""What full damping matrices do; and that those which would feed energy in are refused, and no others.

The first by a formula of its own, the second against a search over motions.
"""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support.water_bodies import Body, flown, random_body, set_state, tumbling

from cube_sim.errors import ModelError
from cube_sim.spatial import rotation_from_quaternion
from cube_sim.vehicle.laws import hydrodynamics
from cube_sim.vehicle.mjcf.damping import require_dissipative, require_pairwise_dissipative

NAME = "hull:damping"
SPEEDS = np.concatenate([np.geomspace(1e-4, 1e4, 801), -np.geomspace(1e-4, 1e4, 801)])


def refuses(check, matrix: np.ndarray) -> bool:
    try:
        check(NAME, matrix)
    except ModelError as error:
        return error.element == NAME
    return False


def least_power_of_a_pair(matrix: np.ndarray) -> float:
    """Smallest nu'D_q(|nu| nu) over motions along axes 2 and 6, the second at speed 1, relative to its parts."""
    t = SPEEDS
    parts = np.array(
        [
            matrix[1, 1] * np.abs(t) ** 3,
            matrix[1, 5] * t,
            matrix[5, 1] * np.abs(t) * t,
            np.full_like(t, matrix[5, 5]),
        ]
    )
    return float((parts.sum(axis=0) / np.abs(parts).sum(axis=0)).min())


def test_pairs_against_a_search():
    rng = np.random.default_rng(0)
    outcomes = set()
    for _ in range(100):
        matrix = np.diag(rng.uniform(0.1, 10.0, 6) ** 2)
        size = np.sqrt(matrix[1, 1] * matrix[5, 5])
        matrix[1, 5], matrix[5, 1] = 2.0 * size * rng.normal(size=2) * rng.choice([1.0, 1.0, 0.0], 2)
        least = least_power_of_a_pair(matrix)
        if abs(least) > 1e-3:  # nearer to the border the grid of the search cannot tell
            assert refuses(require_pairwise_dissipative, matrix) == (least < 0.0)
            outcomes.add(least < 0.0)
    assert outcomes == {True, False}


def test_a_single_entry_has_its_bound_in_closed_form():
    """D_ii t^3 - |D_ij| t + D_jj >= 0 for all t > 0 exactly if 27 D_ii D_jj^2 >= 4 |D_ij|^3."""
    for units in (1e-6, 1.0, 1e6):
        matrix = np.diag([3.0, 5.0, 1.0, 1.0, 1.0, 1.0])
        border = (27.0 * matrix[0, 0] * matrix[1, 1] ** 2 / 4.0) ** (1.0 / 3.0)
        for sign in (1.0, -1.0):
            matrix[0, 1] = sign * border * (1.0 - 1e-6)
            assert not refuses(require_pairwise_dissipative, units * matrix)
            matrix[0, 1] = sign * border * (1.0 + 1e-6)
            assert refuses(require_pairwise_dissipative, units * matrix)


@pytest.mark.parametrize("seed", range(8))
def test_linear_against_its_quadratic_form(seed):
    """A matrix with a known worst direction, and any antisymmetric part on top."""
    rng = np.random.default_rng(seed)
    Q = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    values = rng.uniform(0.0, 5.0, 6)
    values[0] = 0.0
    turning = rng.normal(size=(6, 6)) * 10.0
    matrix = Q @ np.diag(values) @ Q.T + turning - turning.T
    assert not refuses(require_dissipative, matrix)
    leaking = matrix - 1e-3 * np.outer(Q[:, 0], Q[:, 0])
    assert Q[:, 0] @ leaking @ Q[:, 0] < 0.0
    assert refuses(require_dissipative, leaking)


def test_without_damping_nothing_is_refused():
    for check in (require_dissipative, require_pairwise_dissipative):
        assert not refuses(check, np.zeros((6, 6)))
        assert refuses(check, np.diag([0.0, 0.0, 0.0, -1e-9, 0.0, 0.0]))


AXES = [(0, 1, 2), (3, 4, 5), (0, 1, 5), (0, 2, 4), (1, 3, 5), tuple(range(6))]


def coupled(rng: np.random.Generator, axes: tuple[int, ...]) -> np.ndarray:
    """D_q (6,6) with every entry among these axes, dissipative, and with units of its own for each axis."""
    matrix, unit = np.zeros((6, 6)), rng.uniform(0.2, 3.0, 6)
    for i in axes:
        for j in axes:
            matrix[i, j] = 4.0 if i == j else rng.uniform(-1.0, 1.0) / len(axes)
    return matrix * np.outer(unit, unit**2)


@pytest.mark.flight
@pytest.mark.parametrize("axes", AXES, ids=str)
def test_quadratic_damping_that_couples_several_axes(axes):
    """F_i = -sum_j D_q[i, j] |nu_r_j| nu_r_j: the law as Python, compiled, and inside MuJoCo, in a current."""
    rng = np.random.default_rng(sum(axes))
    for _ in range(5):
        state, body = tumbling(rng), replace(random_body(rng), linear=np.zeros((6, 6)), quadratic=coupled(rng, axes))
        R = rotation_from_quaternion(state[3:7])
        nu_r = state[7:] - np.concatenate([R.T @ np.array(body.current), np.zeros(3)])
        drag = np.zeros(6)
        for i in range(6):
            for j in range(6):
                drag[i] += body.quadratic[i, j] * np.sqrt(nu_r[j] ** 2) * nu_r[j]
        arguments = np.zeros((6, 6)), body.quadratic, tuple(nu_r.tolist())
        for law in (hydrodynamics.damping, hydrodynamics.damping.py_func):
            np.testing.assert_allclose(law(*arguments), drag, rtol=1e-12, atol=1e-13)

        forces = []
        for hull in (body, replace(body, quadratic=np.zeros((6, 6)))):
            model = hull.model()
            data = mujoco.MjData(model)
            set_state(data, state)
            mujoco.mj_forward(model, data)
            forces.append(np.concatenate([R.T @ data.qfrc_passive[:3], data.qfrc_passive[3:6]]))
        np.testing.assert_allclose(forces[1] - forces[0], drag, atol=1e-11)
        assert np.count_nonzero(drag) == len(axes)
        assert nu_r @ drag > 0.0


def test_one_entry_is_one_force_from_one_velocity():
    """Row: where the force acts. Column: whose square it is. Twice the speed, four times the force, the other way."""
    body = Body(quadratic=np.diag([3.0] * 6))
    for row in range(6):
        for column in range(6):
            body.quadratic[:] = 3.0 * np.eye(6)
            body.quadratic[row, column] += 1.0
            model = body.model()
            data = mujoco.MjData(model)
            for speed in (0.5, -0.5, 1.0):
                data.qvel[:] = speed * np.eye(6)[column]
                mujoco.mj_forward(model, data)
                expected = -3.0 * abs(speed) * speed * np.eye(6)[column]
                expected[row] -= abs(speed) * speed
                expected[2] += 98.1  # buoyancy
                np.testing.assert_allclose(data.qfrc_passive, expected, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_body_with_full_damping_only_loses_energy(seed):
    rng = np.random.default_rng(seed)
    body = replace(random_body(rng), current=(0.0, 0.0, 0.0), cb=np.zeros(3), cg=np.zeros(3))
    body = replace(body, volume=body.mass / 1000.0, linear=np.zeros((6, 6)), quadratic=coupled(rng, AXES[-1]))
    model = body.model()
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    set_state(data, tumbling(rng))
    energies = []
    for _ in range(400):
        mujoco.mj_step(model, data)
        energies.append(data.energy[1])
    assert np.all(np.diff(energies) < 0.0)


@pytest.mark.parametrize(
    ("integrator", "limit"), [("Euler", 2.0), ("implicit", 2.0), ("implicitfast", 2.0), ("RK4", 2.785)]
)
def test_no_integrator_treats_the_waters_drag_implicitly(integrator, limit):
    """d h / (m + a) just below the limit decays, just above it grows: also where the name promises otherwise."""
    h, mass, added = 0.05, 10.0, 6.0
    speeds = []
    for ratio in (0.97 * limit, 1.03 * limit):
        drag = ratio * (mass + added) / h
        body = Body(mass=mass, added=np.diag([added] * 3 + [0.1] * 3), linear=np.diag([drag] * 3 + [1.0] * 3))
        end = flown(body.model(integrator, h), np.array([0, 0, 0, 1.0, 0, 0, 0, 1.0, 0, 0, 0, 0, 0]), 150 * h)
        speeds.append(abs(end[7]))
    assert speeds[0] < 0.1
    assert speeds[1] > 10.0
