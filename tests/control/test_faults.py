"""Losing thrusters: what is left, how it is found out, how the vehicle points what it has."""

from itertools import combinations

import numpy as np
import pytest
from support.vehicles import vehicle

from cube_sim.allocation import Health
from cube_sim.control.attitude_mode import Situation
from cube_sim.control.authority import Authority
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.judged_capability import capability, remaining_capability
from cube_sim.control.yielding import WaterHold
from cube_sim.spatial import rotation_from_quaternion

UPRIGHT = FixedAttitude(np.array([1.0, 0.0, 0.0, 0.0]))


@pytest.fixture(scope="module")
def cube():
    return vehicle("cube")


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
            projected = left.project_onto_range(wrench)
            np.testing.assert_allclose(A @ np.linalg.pinv(A) @ projected, projected, atol=1e-7)
            np.testing.assert_array_equal(projected[3:], wrench[3:])
            # no other force that goes with this torque is nearer
            null = np.linalg.svd(A.T)[2][np.linalg.matrix_rank(A) :]
            free = np.linalg.svd(null[:, :3])[2][np.linalg.matrix_rank(null[:, :3]) :]
            np.testing.assert_allclose(free @ (projected[:3] - wrench[:3]), 0.0, atol=1e-7)


LOSSES = [(0, 1), (0, 2), (4, 7), (1, 3, 5), (0, 1, 2), (4, 6, 7)]


def settled(cube, lost, force, seconds=30.0, dt=0.05):
    """The attitude the law ends at under a constant demand, and its last rates."""
    left = capability(left_after(cube.actuation_matrix, list(lost)))
    mode = BalancedAttitude(left, cube.dynamics, np.eye(3), time=0.5, wish=UPRIGHT)
    R = np.eye(3)
    for _ in range(int(seconds / dt)):
        desired = mode.attitude(Situation(None, R, force, np.zeros(3), np.zeros(3), left.effort), dt)
        R = rotation_from_quaternion(desired.quaternion)
    return R, desired.rates


@pytest.mark.flight
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


@pytest.mark.flight
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


# What thrusters hold [N], by column, and the constant of the only condition the others leave, in the words of the log.
STUCK = [({0: 10.0, 1: 10.0}, 53.3), ({0: -7.0, 1: 12.0}, 13.3), ({0: 15.0, 1: 15.0, 4: 15.0}, 80.0)]


@pytest.mark.parametrize(("stuck", "constant"), STUCK)
def test_beside_stuck_thrusters_only_wrenches_that_contain_what_they_hold_are_asked_for(cube, stuck, constant):
    A, health = cube.actuation_matrix, Health.whole(8)
    for thruster, force in stuck.items():
        health = health.with_thruster(thruster, 0.0, force)
    left = remaining_capability(A, cube.thrusters.limits, health)
    assert left.steers_by_attitude
    others = left_after(A, list(stuck))
    held = A[:, list(stuck)] @ np.array(list(stuck.values()))
    rng = np.random.default_rng(5)
    for wrench in rng.normal(scale=20.0, size=(20, 6)):
        asked = left.project_onto_range(wrench)
        np.testing.assert_allclose(others @ np.linalg.pinv(others) @ (asked - held), asked - held, atol=1e-6)
        np.testing.assert_array_equal(asked[3:], wrench[3:])
        again = left.project_onto_range(asked)
        np.testing.assert_allclose(again, asked, atol=1e-6)
    # The line for the log holds the same number: its left side, of any wrench that can be made.
    assert f"Fx - 0.577 Fy + 1.15 Fz + 2.89 Mx/m + 1.67 My/m - 3.33 Mz/m = {constant:.3g} N always" in left.reason
    Fx, Fy, Fz, Mx, My, Mz = left.project_onto_range(np.array([3.0, -2.0, 5.0, 1.0, -0.5, 0.2]))
    assert Fx - 0.57735 * Fy + 1.1547 * Fz + 2.88675 * Mx + 1.66667 * My - 3.33333 * Mz == pytest.approx(
        constant, abs=0.05
    )


@pytest.mark.parametrize(("stuck", "constant"), STUCK)
def test_the_balanced_attitude_counts_what_stuck_thrusters_hold(cube, stuck, constant):
    """Checked with the hull's own equations of motion: the others can make up the rest of what is needed there."""
    del constant
    health = Health.whole(8)
    for thruster, force in stuck.items():
        health = health.with_thruster(thruster, 0.0, 0.2 * force)
    left = remaining_capability(cube.actuation_matrix, cube.thrusters.limits, health)
    mode, force = BalancedAttitude(left, cube.dynamics, np.eye(3), time=0.5, wish=UPRIGHT), np.array([22.0, 9.0, 2.0])
    R = np.eye(3)
    for _ in range(600):
        desired = mode.attitude(Situation(None, R, force, np.zeros(3), np.zeros(3), left.effort), 0.05)
        R = rotation_from_quaternion(desired.quaternion)
    hold = cube.dynamics.wrench(R, np.zeros(6), np.zeros(6), np.zeros(3))
    rest = np.concatenate([R.T @ force, hold[3:]]) - left.held
    A = left_after(cube.actuation_matrix, list(stuck))
    np.testing.assert_allclose(A @ np.linalg.pinv(A) @ rest, rest, atol=0.02 * np.linalg.norm(force))


def test_a_lost_component_says_what_is_held_in_its_own_unit(matrix_of_two_pairs):
    left = capability(matrix_of_two_pairs, np.array([0.0, 0.0, 0.0, 0.25, 0.0, 0.0]))
    assert "cannot roll: Mx = 0.25 N m always" in left.reason
    assert "Mx = 0 always" in capability(matrix_of_two_pairs).reason


@pytest.fixture
def matrix_of_two_pairs():
    """All forces, pitch and yaw."""
    return np.delete(np.eye(6), 3, axis=1)


def test_thrusters_without_force_are_no_authority(cube):
    A, limits, health = cube.actuation_matrix, cube.thrusters.limits, Health.whole(8)
    for thruster, efficiency in ((0, 0.01), (1, 0.05), (2, 0.099)):
        health = health.with_thruster(thruster, efficiency)
    weak, gone = remaining_capability(A, limits, health), capability(left_after(A, [0, 1, 2]))
    assert weak.authority is gone.authority is Authority.LINE
    np.testing.assert_allclose(weak.lost_forces, gone.lost_forces, atol=1e-12)
    np.testing.assert_array_equal(weak.held, np.zeros(6))
    assert remaining_capability(A, limits, health.with_thruster(2, 0.1)).authority is Authority.PLANE
    assert remaining_capability(A, limits, Health.whole(8).with_thruster(0, 0.5)).authority is Authority.HOLONOMIC
    blocked = limits.copy()
    blocked[:2, 0], blocked[:2, 3] = blocked[:2, 1], blocked[:2, 2]  # their dead zones end where they saturate
    assert remaining_capability(A, blocked, Health.whole(8)).authority is Authority.PLANE


@pytest.mark.parametrize(("stuck_N", "way"), [(15.0, Authority.TRIM), (50.0, Authority.TURNED)])
def test_the_water_holds_what_a_stuck_thruster_makes_of_a_torque_up_to_a_tilt_of_thirty_degrees(stuck_N, way):
    """Nothing pitches this hull but three horizontal thrusters, 60 mm high: the fourth, stuck, leaves it tilted.

    Beyond that it is not left to the water: by the model the hull, turned over, stays in its place.
    """
    hull = vehicle("bluerov2_vectored")
    A, righting = hull.actuation_matrix.copy(), hull.dynamics.righting_moment[2]
    horizontal = np.flatnonzero(np.abs(A[2]) < 1e-9)
    A[3, horizontal[1:]] -= 0.06 * A[1, horizontal[1:]]
    A[4, horizontal[1:]] += 0.06 * A[0, horizontal[1:]]
    stuck = np.full(A.shape[1], np.nan)
    stuck[horizontal[0]] = stuck_N
    hold = WaterHold.of(hull.dynamics, 0.3)
    left = remaining_capability(A, hull.thrusters.limits, Health(np.ones(A.shape[1]), stuck), hold=hold)
    assert left.authority is way
    at_trim = remaining_capability(
        A, hull.thrusters.limits, Health.whole(A.shape[1]).with_thruster(int(horizontal[0]), 0.0), hold=hold
    )
    assert at_trim.authority is Authority.TRIM
    made = A[:, horizontal[0]] * stuck_N
    combination = at_trim.lost[:, 0]
    tilt = abs(combination @ made) / float(np.linalg.norm(combination[3:5])) / righting
    assert (tilt < 0.5) == (way is Authority.TRIM)


def test_a_vehicle_with_small_thrusters_points_small_forces(cube):
    """What hardly turns a hull of 50 N a thruster is all that one of 5 N needs for its path."""
    softness = {}
    for scale in (1.0, 0.1):
        whole = Health.whole(8).with_thruster(0, 0.0).with_thruster(1, 0.0)
        left = remaining_capability(cube.actuation_matrix, scale * cube.thrusters.limits, whole)
        search = BalancedAttitude(left, cube.dynamics, np.eye(3), 1.0, UPRIGHT)
        softness[scale] = float(search.parameters["softness"][0])
    assert softness == {1.0: 0.6, 0.1: pytest.approx(0.012 * 5.144)}
