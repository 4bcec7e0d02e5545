"""The current observer on the vehicle's own equations of motion, and what a wrong knowledge does to it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.vehicles import vehicle

from cube_sim.control.current import CurrentObserver, told_of_water
from cube_sim.control.disturbance import DisturbanceObserver
from cube_sim.spatial import State, quaternion_from_rotation, rotation_about

CURRENT = np.array([0.12, -0.07, 0.03])
DT = 0.02


@pytest.fixture(scope="module", params=["cube", "bluerov2_heavy", "infante"])
def dynamics(request):
    return vehicle(request.param).dynamics


def circling(t: float, speed: float = 0.4, rate: float = 0.13) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Attitude, velocity and its derivative of a vehicle that drives circles, rising; body axes."""
    R = rotation_about(np.array([0.0, 0.0, 1.0]), rate * t)
    nu = np.array([speed, 0.0, 0.1, 0.0, 0.0, rate])
    return R, nu, np.zeros(6)


def estimates(dynamics, believed, seconds: float, time: float = 10.0) -> np.ndarray:
    """What the observers make of the wrench that keeps up the circling motion in a current they do not know."""
    wrench, current = DisturbanceObserver(believed, 1.0), CurrentObserver(believed, time)
    history = []
    for k in range(int(seconds / DT)):
        R, nu, nu_dot = circling(k * DT)
        state = State(np.zeros(3), quaternion_from_rotation(R), R, nu[:3], nu[3:])
        applied = dynamics.wrench(R, nu, nu_dot, CURRENT)
        residual = wrench.update(state, applied, current.estimate, DT)
        history.append(current.update(state, residual, DT).copy())
    return np.array(history)


@pytest.mark.flight
def test_the_current_is_found_by_a_vehicle_that_moves(dynamics):
    found = estimates(dynamics, dynamics, 150.0)
    np.testing.assert_allclose(found[-1], CURRENT, atol=0.01)


@pytest.mark.flight
def test_it_is_approached_at_the_pace_asked_for(dynamics):
    early, late = (np.linalg.norm(estimates(dynamics, dynamics, 8.0, time)[-1] - CURRENT) for time in (3.0, 30.0))
    assert early < 0.6 * late


@pytest.mark.flight
def test_a_wrong_drag_averages_out_over_a_turn(dynamics):
    """Drag is wrong in body axes, the current in world axes: over a whole turn only the current stays."""
    believed = replace(
        dynamics,
        linear_damping=1.2 * dynamics.linear_damping,
        quadratic_damping=1.2 * dynamics.quadratic_damping,
    )
    found = estimates(dynamics, believed, 250.0)
    turn = int(2.0 * np.pi / 0.13 / DT)
    np.testing.assert_allclose(found[-turn:, :2].mean(axis=0), CURRENT[:2], atol=0.04)


@pytest.mark.flight
def test_at_rest_in_still_water_nothing_is_made_of_noise(dynamics):
    observer, rng = CurrentObserver(dynamics, 10.0), np.random.default_rng(3)
    R = Rotation.random(random_state=5).as_matrix()
    state = State(np.zeros(3), quaternion_from_rotation(R), R, np.zeros(3), np.zeros(3))
    for _ in range(3000):
        estimate = observer.update(state, rng.normal(0.0, 0.3, 6), DT)
    assert np.all(np.isfinite(estimate))
    assert np.linalg.norm(estimate) < 0.03


@pytest.mark.parametrize("along", [(), (0,), (0, 5), (3, 4, 5)])
@pytest.mark.parametrize("coefficient", [1e-300, 1.0])
def test_what_no_drag_shows_is_left_alone(dynamics, along, coefficient):
    """Drag along, or about, some axes only, or hardly any: of the others nothing is known, and nothing is divided."""
    linear = np.zeros((6, 6))
    linear[along, along] = coefficient
    hull = replace(dynamics, linear_damping=linear, quadratic_damping=np.zeros((6, 6)))
    observer = CurrentObserver(hull, 10.0)
    R = Rotation.random(random_state=5).as_matrix()
    state = State(np.zeros(3), quaternion_from_rotation(R), R, np.array([0.4, 0.1, -0.2]), np.zeros(3))
    for _ in range(500):
        estimate = observer.update(state, np.full(6, 0.1), DT)
    assert np.linalg.norm(estimate) < 5.0
    seen = R @ np.diag([float(0 in along and coefficient == 1.0), 0.0, 0.0]) @ R.T
    np.testing.assert_allclose(estimate, seen @ estimate, atol=1e-6)


def test_of_what_is_smeared_over_a_turn_and_more_the_water_is_told_little():
    assert told_of_water((3.0, 0.0, 4.0), 0.0) == 1.0
    assert told_of_water((0.0, 0.0, 0.0), 2.0) == 1.0
    assert told_of_water((0.0, 0.3, 0.4), 2.0) == pytest.approx(0.5)  # w T = 1
    assert told_of_water((0.0, 0.0, 3.0), 1.0) == pytest.approx(0.1)
