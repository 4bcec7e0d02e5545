"""Vehicles built for a level plane: what they are asked for, and three ways of giving it to them."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from support.catalogue.wrong import buoyancy_moved
from support.flights import FORCES_ONLY
from support.places import MODELS, SCENARIOS
from support.vehicles import random_rotation, vehicle

import cube_sim
from cube_sim.control import path_follower
from cube_sim.control.attitude_mode import Situation
from cube_sim.control.authority import Authority
from cube_sim.control.balanced_attitude import BalancedAttitude
from cube_sim.control.fixed_attitude import FixedAttitude
from cube_sim.control.judged_capability import NEARLY_LEVEL, capability
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.control.yielding import WaterHold
from cube_sim.errors import ScenarioError
from cube_sim.guidance.line import Line
from cube_sim.guidance.view_record import VIEW, see_level
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.mission import prepare
from cube_sim.scenario import load
from cube_sim.spatial import rotation_from_quaternion

JACK, INFANTE = SCENARIOS / "jack_exact.yaml", SCENARIOS / "infante_circle.yaml"
UPRIGHT = FixedAttitude(np.array([1.0, 0.0, 0.0, 0.0]))


@pytest.fixture(scope="module")
def matrix():
    return vehicle("jack").actuation_matrix


def test_jack_moves_in_a_level_plane_also_with_any_one_motor_lost(matrix):
    for lost in [(), (0,), (1,), (2,), (3,)]:
        assert capability(np.delete(matrix, lost, axis=1)).authority is Authority.LEVEL


def test_any_two_motors_of_jack_make_a_unicycle_and_one_makes_nothing(matrix):
    for lost in combinations(range(4), 2):
        left = capability(np.delete(matrix, lost, axis=1))
        assert left.authority is Authority.UNICYCLE
        assert left.level
        assert left.steers_by_attitude
    for kept in range(4):
        assert capability(matrix[:, [kept]]).authority is Authority.SAFE


def test_a_thruster_a_little_too_low_leaves_a_hull_in_its_plane_as_far_as_the_water_holds_it():
    hull = vehicle("infante")
    hold, A = WaterHold.of(hull.dynamics, 0.8), hull.actuation_matrix
    lever = NEARLY_LEVEL * hold.righting[2] / hold.force[0]
    for low_m, expected in ((0.03, Authority.UNICYCLE), (0.9 * lever, Authority.UNICYCLE), (1.1 * lever, None)):
        misbuilt = A.copy()
        misbuilt[4] = low_m * A[0]
        left = capability(misbuilt, hold=hold)
        assert (left.authority is Authority.UNICYCLE) is (expected is Authority.UNICYCLE)
        assert capability(misbuilt).authority is not Authority.UNICYCLE  # nothing is known to hold it
    lifted = A.copy()
    lifted[2] = 1.1 * NEARLY_LEVEL * A[0]
    assert capability(lifted, hold=hold).authority is not Authority.UNICYCLE
    rolled = np.column_stack([A, [0.0, 0.0, 0.0, 0.1, 0.0, 0.0]])  # a roll of its own: none of the plane's
    assert capability(rolled, hold=hold).authority is not Authority.UNICYCLE


def test_a_unicycle_is_asked_for_its_torque_and_the_nearest_force_that_comes_with_it(matrix):
    for lost in combinations(range(4), 2):
        A = np.delete(matrix, lost, axis=1)
        asked = capability(A).project_onto_range(np.array([3.0, -2.0, 5.0, 1.0, 1.0, 0.7]))
        np.testing.assert_allclose(A @ np.linalg.pinv(A) @ asked, asked, atol=1e-12)
        np.testing.assert_array_equal(asked[2:], [0.0, 0.0, 0.0, 0.7])


def test_a_unicycle_turns_about_the_vertical_only_until_its_thrust_points_where_force_is_needed(matrix):
    left = capability(np.delete(matrix, [1, 2], axis=1))
    law = BalancedAttitude(left, vehicle("jack").dynamics, np.eye(3), time=0.5, wish=UPRIGHT)
    force = np.array([3.0, 9.0, -4.0])  # world axes; the vertical part is nobody's business
    view = VirtualTarget(Line([0, 0, 0], [10, 0, 0]), 0.5).view(np.zeros(3), np.zeros(3))
    R = np.eye(3)
    for _ in range(1500):
        wanted = law.attitude(Situation(view, R, force, np.zeros(3), np.zeros(3), np.eye(6)), 0.02)
        np.testing.assert_allclose(wanted.rates[:2], 0.0, atol=1e-12)
        R = rotation_from_quaternion(wanted.quaternion)
    body = R.T @ force
    np.testing.assert_allclose(left.lost_forces.T @ body, 0.0, atol=0.02 * np.linalg.norm(force))


def test_a_vehicle_built_as_a_unicycle_gets_the_planar_law_unless_told_otherwise():
    infante = {"control": {}}
    assert isinstance(prepare(load(INFANTE, infante)).controller, PlanarFollower)
    assert isinstance(prepare(load(INFANTE, {"control": {"law": "motion_6dof"}})).controller, PathFollower)


def test_only_what_lies_in_the_plane_is_demanded(matrix):
    level = capability(matrix)
    np.testing.assert_array_equal(level.project_onto_range(np.arange(1.0, 7.0)), [1.0, 2.0, 0.0, 0.0, 0.0, 6.0])
    # and all of that can be made
    wrench = np.array([1.0, 2.0, 0.0, 0.0, 0.0, 6.0])
    np.testing.assert_allclose(matrix @ np.linalg.pinv(matrix) @ wrench, wrench, atol=1e-12)


def test_a_path_that_climbs_is_refused_at_its_place():
    climbing = {"path.points_m": [[0, 0, -3], [8, 0, -3], [8, 6, -4]]}
    with pytest.raises(
        ScenarioError, match="path: this path climbs or sinks, and the vehicle has thrusters for a level"
    ):
        prepare(load(JACK, climbing))


def flown(tmp_path, method, penalty=0.0):
    """Reversals of all thrusters, and rms of the wrench missed [N], over 12 s of cruise."""
    changes = {
        "duration_s": 20,
        "checks.0.from_s": 8,
        "allocation.method": method,
        "allocation.reversal_penalty_N2": penalty,
    }
    signals = cube_sim.run(JACK, changes, out=tmp_path / method).signals
    cruise = signals["thrusters.force_demanded"][:, 0] > 8.0
    force = signals["thrusters.force_demanded"][cruise, 1:]
    reversals = sum(np.count_nonzero(np.diff(np.sign(column[column != 0.0]))) for column in force.T)
    missed = signals["allocation.residual"][cruise, 1]
    return reversals, float(np.sqrt(np.mean(missed**2)))


@pytest.mark.flight
def test_contraction_oscillates_and_misses_compensation_and_the_exact_allocation_do_not(tmp_path):
    """The comparison of Ropars et al. 2018 and Lapierre et al. 2021 on one path."""
    exact, contraction, compensation = (
        flown(tmp_path, "search+proxqp", 100.0),
        flown(tmp_path, "contraction"),
        flown(tmp_path, "compensation"),
    )
    assert exact[0] == compensation[0] == 0
    assert contraction[0] >= 10
    assert exact[1] < 1e-9
    assert compensation[1] < 1e-9
    assert contraction[1] > 5.0


@pytest.mark.parametrize("seed", range(4))
def test_height_is_taken_out_of_a_view_and_nothing_else(seed):
    rng = np.random.default_rng(seed)
    R, view = random_rotation(rng), np.zeros(1, VIEW)
    view["frame"], view["error"], view["velocity"] = R, *rng.normal(size=(2, 3))
    before = view.copy()
    see_level(view)
    for name in ("error", "velocity"):
        level = R @ before[name][0] * (1.0, 1.0, 0.0)
        np.testing.assert_allclose(R @ view[name][0], level, atol=1e-12)


@pytest.mark.flight
@pytest.mark.parametrize("whole", [True, False])
def test_a_hull_that_leaves_its_depth_keeps_its_speed_and_its_path_in_the_plane(whole, tmp_path, monkeypatch):
    """Its buoyancy is 1 cm too far astern: it floats 18 degrees nose down, and sinks."""
    if not whole:
        monkeypatch.setattr(path_follower, "compiled_parts", lambda *_: None)
    (tmp_path / "model.xml").write_text(buoyancy_moved((MODELS / "jack.xml").read_text(), (-0.01, 0.0, 0.0)))
    settings = {
        "model": tmp_path / "model.xml",
        "path": {"type": "line", "start_m": [0.0, 0.0, -20.0], "end_m": [40.0, 0.0, -20.0]},
        "initial": {"position_m": [0.0, 0.2, -20.0], "attitude_deg": [0.0, 0.0, 0.0]},
        "guidance.speed_m_s": 0.3,
        "current_m_s": [0.0, 0.0, 0.0],
        "duration_s": 60.0,
        "checks": FORCES_ONLY,
    }
    signals = cube_sim.run(JACK, settings, out=tmp_path / "run").signals
    position, t = signals["pose.position"][:, 1:], signals["pose.position"][:, 0]
    late = t >= 30.0
    assert position[-1, 2] < -22.0
    assert np.ptp(position[late, 0]) > 0.88 * 0.3 * 30.0  # the square of the tilt's cosine is 0.90
    assert np.abs(position[late, 1]).max() < 0.01
