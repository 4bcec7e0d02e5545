"""When the path cannot be followed: given up with a reason, held or surfaced, and taken up again."""

import numpy as np
import pytest
from support.flights import FORCES_ONLY, said, thruster_event
from support.places import HELIX

import cube_sim
from cube_sim.control.safe_mode import LossOfTargetMonitor, SafeMode, SafeModeGoal
from cube_sim.guidance.line import Line
from cube_sim.guidance.virtual_target import VirtualTarget
from cube_sim.spatial import State, quaternion_from_euler, rotation_from_quaternion

ON_PATH = {"initial.position_m": [3, 0, -8], "initial.attitude_deg": [0, 0, 90], "checks": FORCES_ONLY}
ALL = [f"T{i}" for i in range(1, 9)]
SAFE = 3


def view_at(distance):
    return VirtualTarget(Line([0, 0, 0], [10, 0, 0]), 0.5).view(np.array([0.0, distance, 0.0]), np.zeros(3))


def still_at(position, yaw=0.4, pitch=0.3):
    q = quaternion_from_euler(0.1, pitch, yaw)
    return State(np.array(position), q, rotation_from_quaternion(q), np.zeros(3), np.zeros(3))


def test_the_watch_gives_up_only_after_its_patience_and_forgets_when_the_path_is_near_again():
    monitor = LossOfTargetMonitor(SafeMode(limit=2.0, patience=1.0))
    assert not any(monitor.reason(view_at(9.0), 0.1) for _ in range(99))  # it has yet to come near
    assert not monitor.reason(view_at(1.0), 0.1)
    assert not any(monitor.reason(view_at(2.5), 0.1) for _ in range(9))
    assert not monitor.reason(view_at(1.9), 0.1)
    reasons = [monitor.reason(view_at(2.5), 0.1) for _ in range(12)]
    assert not any(reasons[:9])
    assert reasons[-1] == "2.5 m from its target on the path, beyond 2 m for 1 s"


def test_a_path_taken_up_again_from_far_off_is_lost_only_when_the_vehicle_comes_no_nearer():
    monitor, dt = LossOfTargetMonitor(SafeMode(limit=2.0, patience=1.0)), 0.125
    assert not monitor.reason(view_at(1.0), dt)
    away = [bool(monitor.reason(view_at(2.0 + 0.5 * k), dt)) for k in range(1, 9)]
    assert away == [False] * 7 + [True]
    monitor.restart()
    turning = [6.0, 6.2, 6.3, 6.2, 6.0]
    assert not any(monitor.reason(view_at(d), dt) for d in turning)
    assert not any(monitor.reason(view_at(6.0 - 0.0125 * k), dt) for k in range(240))  # 0.1 m/s, 30 s
    waits = [bool(monitor.reason(view_at(3.0 - 1e-4 * k), dt)) for k in range(20)]
    assert waits[0] is False
    assert waits[-1] is True


def test_a_safe_mode_goal_is_where_the_vehicle_was_level_with_its_heading():
    goal = SafeModeGoal(SafeMode(speed=0.2, time=5.0), still_at([1.0, 2.0, -3.0]), "lost")
    assert goal.reason == "lost; it holds its position as well as it can"
    np.testing.assert_allclose(goal.motion(np.array([1.0, 2.5, -3.0])).velocity, [0.0, -0.1, 0.0], atol=1e-12)
    assert np.linalg.norm(goal.motion(np.array([50.0, 2.0, -3.0])).velocity) == pytest.approx(0.2)
    np.testing.assert_array_equal(goal.motion(np.array([1.0, 2.0, -3.0])).velocity, np.zeros(3))


def test_surfacing_rises_above_the_same_place():
    goal = SafeModeGoal(SafeMode(surface=0.0), still_at([1.0, 2.0, -3.0]), "lost")
    np.testing.assert_allclose(goal.motion(np.array([1.0, 2.0, -3.0])).velocity, [0.0, 0.0, 0.2], atol=1e-12)
    assert goal.reason.endswith("it makes for the surface")


def test_a_surface_below_the_vehicle_is_said():
    goal = SafeModeGoal(SafeMode(surface=-20.0), still_at([1.0, 2.0, -8.0]), "lost")
    np.testing.assert_allclose(goal.motion(np.array([1.0, 2.0, -8.0])).velocity, [0.0, 0.0, -0.2], atol=1e-12)
    assert goal.reason == "lost; it makes for the surface, 12 m below it"


def flown(tmp_path, changes):
    run = cube_sim.run(HELIX, {**ON_PATH, **changes}, out=tmp_path)
    return run.signals, said(run)


@pytest.mark.flight
def test_without_a_thruster_left_the_ballast_brings_it_to_the_surface(tmp_path):
    safe = {"action": "surface", "drop_weight_N": 15.0}
    dead = {"duration_s": 50, "events": [thruster_event(8, ALL)], "control.safe_mode": safe}
    signals, log = flown(tmp_path, {**dead, "surface_m": -5.0})
    height = signals["pose.position"][:, 3]
    assert height[400] < -7.5  # it was still at depth when they died
    # comes up, and bobs about its draught: 15 N lighter, its ball of 0.31 m radius has 1.2 % of it out of the water
    assert np.all(np.abs(height[-500:] + 5.0 + 0.29) < 0.15)
    assert height[-500:].mean() == pytest.approx(-5.29, abs=0.05)
    assert signals["health.authority"][-1, 1] == SAFE
    told = [text for text in log if text.startswith("the path is given up")]
    assert len(told) >= 1
    assert "the ballast is dropped" in log
    assert log.count("the ballast is dropped") == 1


@pytest.mark.flight
def test_a_current_stronger_than_the_vehicle_makes_it_give_up_and_hold(tmp_path):
    safe = {"action": "hold", "distance_limit_m": 2.0, "patience_s": 3.0}
    events = [
        {"kind": "current", "at_s": 10, "current_m_s": [0.0, -2.5, 0.0]},
        {"kind": "current", "at_s": 18, "current_m_s": [0.0, 0.1, 0.0]},
    ]
    signals, log = flown(tmp_path, {"duration_s": 60, "events": events, "control.safe_mode": safe})
    given_up = [text for text in log if text.startswith("the path is given up")]
    assert len(given_up) == 1
    assert "m from its target on the path, beyond 2 m for 3 s; it holds its position" in given_up[0]
    authority = signals["health.authority"]
    at = int(np.argmax(authority[:, 1] == SAFE))
    place = signals["pose.position"][at, 1:]
    np.testing.assert_allclose(signals["pose.position"][-1, 1:], place, atol=0.1)


@pytest.mark.flight
def test_thrusters_that_come_back_end_the_safe_mode(tmp_path):
    lost = ALL
    events = [thruster_event(8, lost), thruster_event(20, lost, "recovered")]
    changes = {"duration_s": 55, "events": events, "control.faults": "told"}
    signals, log = flown(tmp_path, changes)
    assert "the path is followed again" in log
    authority = signals["health.authority"][:, 1]
    assert authority[600] == SAFE
    assert authority[-1] == 0
    assert signals["path_error.cross_track"][-1, 1] < 0.05


@pytest.mark.flight
@pytest.mark.parametrize(
    ("faults", "fault"),
    [("told", {}), ("diagnosed", {}), ("told", {"state": "weak", "efficiency": 0.02})],
    ids=["told", "diagnosed", "weak"],
)
def test_a_vehicle_carried_far_off_takes_its_path_up_again_once_its_thrusters_are_back(faults, fault, tmp_path):
    events = [thruster_event(8, ALL, **fault), thruster_event(40, ALL, "recovered")]
    safe = {"distance_limit_m": 2.0, "patience_s": 4.0}
    changes = {"control.faults": faults, "control.safe_mode": safe, "current_m_s": [0, 0.3, 0]}
    signals, log = flown(tmp_path, {"duration_s": 100, "events": events, **changes})
    told = [text for text in log if text.startswith("the path is")]
    assert told[-1] == "the path is followed again"
    error = np.linalg.norm(signals["path_error.lateral"][:, 1:], axis=1)
    assert error.max() > 3.0  # beyond the limit for longer than the patience, on its way back
    assert error[-500:].max() < 0.02
    assert signals["health.authority"][-1, 1] == 0
