"""The attitude of least effort: its gradient, where it settles, and that it always gets upright."""

import numpy as np
import pytest
from support.catalogue.vehicles import catalogue
from support.flights import FORCES_ONLY
from support.vehicles import vehicle

import cube_sim
from cube_sim.control.attitude_mode import Situation
from cube_sim.control.effort import effort_matrix
from cube_sim.control.free_attitude import MAX_RATE, FreeAttitude
from cube_sim.control.judged_capability import capability
from cube_sim.guidance.law import TargetView
from cube_sim.guidance.path import PathPoint
from cube_sim.spatial import quaternion_from_euler, rotation_about, rotation_from_quaternion, skew

HERE = PathPoint(np.zeros(3), np.eye(3), (0.0, 0.0), (0.0, 0.0))
STILL, DT, TIME = np.zeros(3), 0.05, 3.0


@pytest.fixture(scope="module")
def cube():
    return vehicle("cube")


@pytest.fixture(scope="module")
def bluerov2():
    return vehicle("bluerov2_heavy")


def needed(vehicle, R, velocity, current):
    """The wrench (6,) of steady motion without turning: the hull's own equations of motion."""
    return vehicle.dynamics.wrench(R, np.concatenate([R.T @ velocity, STILL]), np.zeros(6), current)


def settle(vehicle, R, velocity, current, rest=STILL, duration=60.0):
    """(R, rates) at each tick of a vehicle that turns as wanted, `rest` (3,) the force asked for beside drag."""
    mode, effort = FreeAttitude(vehicle.dynamics, TIME), effort_matrix(vehicle.actuation_matrix)
    view = TargetView(0.0, 1.0, 0.0, HERE, STILL, velocity)
    for _ in range(round(duration / DT)):
        force = R @ needed(vehicle, R, velocity, current)[:3] + rest
        desired = mode.attitude(Situation(view, R, force, STILL, current, effort), DT)
        yield R, desired.rates
        R = rotation_from_quaternion(desired.quaternion)


def effort(vehicle, R, velocity, current):
    """Least |f|^2 [N^2] of the steady motion."""
    w = needed(vehicle, R, velocity, current)
    return float(w @ effort_matrix(vehicle.actuation_matrix) @ w)


def random_rotations(seed, n):
    for q in np.random.default_rng(seed).normal(size=(n, 4)):
        yield rotation_from_quaternion(q / np.linalg.norm(q))


def test_the_effort_is_the_least_sum_of_squares(bluerov2):
    A = bluerov2.actuation_matrix
    for w in np.random.default_rng(1).normal(size=(20, 6)):
        f = np.linalg.lstsq(A, w, rcond=None)[0]
        assert w @ effort_matrix(A) @ w == pytest.approx(f @ f)


def test_the_slope_of_the_effort_is_the_closed_form_where_there_is_one(bluerov2):
    """Without drag: dE = 2 w' Q [S(F); -S(r) S(z)] dphi for w = [F; -r x z]."""
    Q = effort_matrix(bluerov2.actuation_matrix)
    r = np.array([0.2, -0.5, 3.0])
    rng = np.random.default_rng(2)
    for R in random_rotations(3, 20):
        force = rng.normal(0.0, 20.0, 3)

        def E(turn, R=R, force=force):
            angle = np.linalg.norm(turn)
            turned = R @ rotation_about(turn / angle, angle)
            w = np.concatenate([turned.T @ force, -np.cross(r, turned[2])])
            return w @ Q @ w

        F, z = R.T @ force, R[2]
        w = np.concatenate([F, -np.cross(r, z)])
        slope = 2.0 * w @ Q @ np.vstack([skew(F), -skew(r) @ skew(z)])
        h = 1e-6
        numbers = [(E(h * axis) - E(-h * axis)) / (2.0 * h) for axis in np.eye(3)]
        np.testing.assert_allclose(numbers, slope, rtol=1e-5, atol=1e-3)


def test_its_rate_is_the_damped_step_down_the_true_effort(bluerov2):
    """Against the formula written out: the drag of the hull as turned, and a force in the world that stays."""
    Q = effort_matrix(bluerov2.actuation_matrix)
    g, hull = 9.81, bluerov2.dynamics
    r = g * (hull.displaced_mass * hull.centre_of_buoyancy - bluerov2.mass * hull.centre_of_mass)
    weight = np.trace(Q[3:, 3:]) / 3.0
    rng, checked = np.random.default_rng(6), 0
    for R in random_rotations(7, 40):
        if R[2, 2] < 0.1:
            continue
        velocity, current, rest = rng.normal(0.0, 0.2, 3), rng.normal(0.0, 0.2, 3), rng.normal(0.0, 3.0, 3)

        def w(turn, R=R, velocity=velocity, current=current, rest=rest):
            angle = np.linalg.norm(turn)
            turned = R @ rotation_about(turn / angle, angle) if angle > 0.0 else R
            wrench = needed(bluerov2, turned, velocity, current) + np.append(turned.T @ rest, STILL)
            return np.append(np.linalg.cholesky(Q).T @ wrench, np.sqrt(weight) * (np.linalg.norm(r) - r @ turned[2]))

        y, h = w(STILL), 1e-5
        J = np.column_stack([(w(h * axis) - w(-h * axis)) / (2.0 * h) for axis in np.eye(3)])
        step = -np.linalg.solve(J.T @ J + (0.2 * y @ y + 1.0) * np.eye(3), J.T @ y) / TIME
        (_, rates), *_ = settle(bluerov2, R, velocity, current, rest, DT)
        if np.linalg.norm(step) < MAX_RATE:
            np.testing.assert_allclose(R.T @ rates, step, atol=1e-4)
            assert step @ J.T @ y < 0.0
            checked += 1
    assert checked > 10


@pytest.mark.flight
def test_the_effort_falls_all_the_way_and_ends_lower_than_any_heading_of_a_level_vehicle(bluerov2):
    """A BlueROV2 that stands in a current of 0.45 m/s, from attitudes up to a right angle from upright."""
    current = np.array([0.0, 0.45, 0.0])
    level = [
        effort(bluerov2, rotation_from_quaternion(quaternion_from_euler(0.0, 0.0, yaw)), STILL, current)
        for yaw in np.linspace(0.0, 2.0 * np.pi, 73)
    ]
    for R in random_rotations(4, 4):
        if R[2, 2] < 0.0:
            R = R @ rotation_about(np.array([1.0, 0.0, 0.0]), np.pi)
        efforts = np.array([effort(bluerov2, R, STILL, current) for R, _ in settle(bluerov2, R, STILL, current)])
        assert np.all(np.diff(efforts[80:]) <= 1e-3 * efforts[80:-1])
        assert efforts[-1] <= min(level) * 1.001
        assert efforts[-1] < 0.8 * level[0]


@pytest.mark.flight
def test_the_cube_has_no_cheap_axis_and_only_rights_itself(cube):
    """Isotropic thrust and, along its axes, drag: what is left of the effort's slope is buoyancy."""
    for R in random_rotations(5, 3):
        *_, (R, rates) = settle(cube, R, STILL, STILL, rest=np.array([15.0, 0.0, 0.0]))
        assert np.degrees(np.arccos(R[2, 2])) < 0.5
        assert np.linalg.norm(rates) < 1e-3


@pytest.mark.flight
@pytest.mark.parametrize("attitude", [(180, 0, 0), (0, 180, 0), (180, 0, 77), (179.9, 0, 0), (90, 0, 0), (0, -90, 0)])
@pytest.mark.parametrize("name", ["cube", "bluerov2"])
def test_from_upside_down_it_comes_upright_in_one_piece(name, attitude, request):
    """At 180 degrees no torque is needed to hang there, but no hull does; there and at 90 nothing is singular."""
    vehicle = request.getfixturevalue(name)
    R = rotation_from_quaternion(quaternion_from_euler(*np.radians(attitude)))
    tilts = []
    for now, rates in settle(vehicle, R, STILL, STILL, duration=50.0):
        assert np.linalg.norm(rates) <= MAX_RATE + 1e-12
        tilts.append(np.arccos(np.clip(now[2, 2], -1.0, 1.0)))
    assert np.all(np.diff(tilts) <= 1e-7)
    assert tilts[-1] < 0.01


def test_its_rates_are_the_derivative_of_the_attitude(bluerov2):
    current = np.array([0.3, 0.3, 0.0])
    R = rotation_from_quaternion(quaternion_from_euler(0.5, -0.3, 2.0))
    steps = list(settle(bluerov2, R, np.array([0.2, 0.0, 0.0]), current, duration=4.0))
    for k in range(2, len(steps) - 1, 17):
        slope = (steps[k + 1][0] - steps[k - 1][0]) / (2.0 * DT)
        np.testing.assert_allclose(slope, skew(steps[k][1]) @ steps[k][0], atol=0.01 * MAX_RATE)


def test_a_vehicle_with_nothing_to_do_turns_no_way(cube):
    R = rotation_from_quaternion(quaternion_from_euler(0.0, 0.0, 1.0))
    for _, rates in settle(cube, R, STILL, STILL, duration=1.0):
        np.testing.assert_allclose(rates, 0.0, atol=1e-9)


def test_when_thrusters_are_lost_it_reckons_with_those_that_are_left(bluerov2):
    A, current = bluerov2.actuation_matrix, np.array([0.0, 0.45, 0.0])
    left = capability(np.delete(A, [0], axis=1))
    np.testing.assert_array_equal(left.effort, effort_matrix(np.delete(A, [0], axis=1)))
    view = TargetView(0.0, 1.0, 0.0, HERE, STILL, STILL)
    R = rotation_from_quaternion(quaternion_from_euler(0.1, 0.2, 0.3))
    force = R @ needed(bluerov2, R, STILL, current)[:3]

    def rates(mode, effort):
        return mode.attitude(Situation(view, R, force, STILL, current, effort), 0.0).rates

    veteran, fresh = FreeAttitude(bluerov2.dynamics, TIME), FreeAttitude(bluerov2.dynamics, TIME)
    before = rates(veteran, effort_matrix(A))
    np.testing.assert_array_equal(rates(veteran, left.effort), rates(fresh, left.effort))
    assert np.linalg.norm(before - rates(fresh, left.effort)) > 0.01


def test_upright_is_where_the_righting_moment_rests(bluerov2):
    for R in random_rotations(7, 20):
        there = FreeAttitude(bluerov2.dynamics, TIME).upright(R)
        righting = bluerov2.dynamics.righting_moment
        np.testing.assert_allclose(there @ righting, [0.0, 0.0, np.linalg.norm(righting)], atol=1e-9)
        tilt = np.arccos(np.clip((R @ righting)[2] / np.linalg.norm(righting), -1.0, 1.0))
        assert np.arccos(0.5 * (np.trace(there.T @ R) - 1.0)) == pytest.approx(tilt, abs=1e-6)  # the shortest way
    upside_down = np.diag([1.0, -1.0, -1.0])
    assert FreeAttitude(bluerov2.dynamics, TIME).upright(upside_down)[2, 2] == pytest.approx(1.0)


@pytest.mark.flight
def test_a_hull_too_heavy_to_be_held_upside_down_rights_itself_and_flies_on(tmp_path):
    """1.9 t that rights itself harder than its thrusters turn it: on its way it is short, and was sent back over."""
    model = tmp_path / "model.xml"
    model.write_text(catalogue()["rexrov"].make())
    scenario = {
        "schema_version": 1,
        "name": "upside_down",
        "model": str(model),
        "duration_s": 40.0,
        "initial": {"position_m": [1.3, 0.1, -19.8], "attitude_deg": [-164.0, 22.0, -134.0]},
        "path": {"type": "line", "start_m": [0, 0, -20], "end_m": [8, -60, -26]},
        "guidance": {"speed_m_s": 0.5},
        "control": {"attitude": {"mode": "free"}},
        "checks": FORCES_ONLY,
    }
    signals = cube_sim.fly(scenario, out=tmp_path / "run", record="none").signals
    t, error = signals["path_error.cross_track"].T
    assert error.max() < 2.0
    assert error[t > 35.0].max() < 0.01
