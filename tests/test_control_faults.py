"""Losing thrusters: what is left, how it is found out, how the vehicle points what it has."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import cube_sim
from cube_sim.allocation import Health
from cube_sim.control.attitude import Situation
from cube_sim.control.authority import Authority, capability
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.diagnosis import Diagnosis
from cube_sim.spatial import rotation_from_quaternion


@pytest.fixture(scope="module")
def cube():
    return cube_sim.Vehicle.from_model(cube_sim.load_model(Path(__file__).parents[1] / "models" / "cube.xml"))


def left_after(A, lost):
    return np.delete(A, lost, axis=1)


@pytest.mark.parametrize(
    ("lost", "expected"),
    [
        (1, {Authority.HOLONOMIC: 8}),
        (2, {Authority.HOLONOMIC: 16, Authority.PLANE: 12}),
        (3, {Authority.PLANE: 48, Authority.LINE: 8}),
    ],
)
def test_every_loss_of_the_cube_leaves_what_exact_geometry_says(cube, lost, expected):
    found = [capability(left_after(cube.actuation_matrix, list(c))).authority for c in combinations(range(8), lost)]
    assert {kind: found.count(kind) for kind in set(found)} == expected


def test_pure_torques_and_no_thrusters_at_all_are_safe_mode(cube):
    torques = np.vstack([np.zeros((3, 3)), np.eye(3)])
    assert capability(torques).authority is Authority.SAFE
    assert capability(np.zeros((6, 0))).authority is Authority.SAFE


def test_demands_are_projected_onto_the_range_with_all_their_torque(cube):
    rng = np.random.default_rng(1)
    for lost in ([0, 1], [0, 2], [1, 3, 5], [0, 1, 2]):
        A = left_after(cube.actuation_matrix, lost)
        left = capability(A)
        for wrench in rng.normal(size=(20, 6)):
            projected = left.attainable(wrench)
            np.testing.assert_allclose(A @ np.linalg.pinv(A) @ projected, projected, atol=1e-12)
            np.testing.assert_array_equal(projected[3:], wrench[3:])
            # no other force that goes with this torque is nearer
            null = np.linalg.svd(A.T)[2][np.linalg.matrix_rank(A) :]
            free = np.linalg.svd(null[:, :3])[2][np.linalg.matrix_rank(null[:, :3]) :]
            np.testing.assert_allclose(free @ (projected[:3] - wrench[:3]), 0.0, atol=1e-12)


LOSSES = [(0, 1), (0, 2), (4, 7), (1, 3, 5), (0, 1, 2), (4, 6, 7)]


def settled(cube, lost, force, seconds=30.0, dt=0.05):
    """The attitude the law ends at under a constant demand, and its last rates."""
    left = capability(left_after(cube.actuation_matrix, list(lost)))
    mode = BalancedAttitude(left, cube.dynamics, np.eye(3), time=0.5)
    for _ in range(int(seconds / dt)):
        desired = mode.attitude(Situation(None, np.eye(3), force, np.zeros(3), left.effort), dt)
    return rotation_from_quaternion(desired.quaternion), desired.rates


@pytest.mark.parametrize("lost", LOSSES)
def test_at_the_balanced_attitude_the_force_and_what_holds_the_hull_are_both_there(cube, lost):
    """Checked with the hull's own equations of motion and the columns of A, not with the law's formula."""
    A = left_after(cube.actuation_matrix, list(lost))
    rng = np.random.default_rng(2)
    for _ in range(4):
        bearing, size = rng.uniform(-np.pi, np.pi), rng.uniform(8.0, 30.0)
        force = np.array([size * np.cos(bearing), size * np.sin(bearing), rng.uniform(-3.0, 3.0)])
        R, _ = settled(cube, lost, force)
        hold = cube.dynamics.wrench(R, np.zeros(6), np.zeros(6), np.zeros(3))
        wrench = np.concatenate([R.T @ force, hold[3:]])
        np.testing.assert_allclose(A @ np.linalg.pinv(A) @ wrench, wrench, atol=0.02 * np.linalg.norm(force))


@pytest.mark.parametrize("lost", LOSSES)
def test_it_tilts_little_for_a_force_near_the_horizontal(cube, lost):
    for bearing in np.linspace(0.0, 2.0 * np.pi, 7)[:-1]:
        R, _ = settled(cube, lost, np.array([20.0 * np.cos(bearing), 20.0 * np.sin(bearing), 2.0]))
        assert np.degrees(np.arccos(R[2, 2])) < 35.0


@pytest.mark.parametrize("lost", LOSSES)
def test_without_a_force_it_stays_and_rights_itself(cube, lost):
    R, rates = settled(cube, lost, np.zeros(3))
    np.testing.assert_allclose(R, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(rates, np.zeros(3), atol=1e-9)


def motors(kind: str, n: int = 200):
    """(commands, true forces) of one thruster with characteristic F = 40 c, lag 20 ms, that fails after a second."""
    rng = np.random.default_rng(3)
    commands = 0.5 * np.sin(0.05 * np.arange(n)) + 0.2 * rng.normal(size=n).cumsum() / 14.0
    activation, forces = 0.0, []
    for k, c in enumerate(commands):
        healthy = 40.0 * activation
        failed = {"dead": 0.0, "weak": 0.5 * healthy, "stuck": 7.0, "whole": healthy}[kind]
        forces.append(failed if k >= 50 else healthy)
        activation = c + (activation - c) * np.exp(-1.0)
    return commands, np.array(forces)


@pytest.mark.parametrize(
    ("kind", "efficiency", "stuck"),
    [("whole", 1.0, None), ("dead", 0.0, None), ("weak", 0.5, None), ("stuck", 0.0, 7.0)],
)
def test_a_fault_is_found_from_command_and_response(kind, efficiency, stuck):
    commands, forces = motors(kind)
    diagnosis = Diagnosis(np.array([0.02]), window_s=0.5, threshold_N=1.0, dt=0.02)
    found_at = None
    for k, (c, f) in enumerate(zip(commands, forces, strict=True)):
        health = diagnosis.update(40.0 * diagnosis.activation, np.array([f]))
        diagnosis.advance(np.array([c]))
        if found_at is None and not health.equals(Health.whole(1)):
            found_at = k
    assert health.efficiency[0] == pytest.approx(efficiency, abs=0.06)
    if stuck is None:
        assert np.isnan(health.stuck[0])
    else:
        assert health.stuck[0] == pytest.approx(stuck)
    if kind == "whole":
        assert found_at is None
    else:
        assert found_at is not None
        assert 50 <= found_at <= 50 + 60  # within 1.2 s
