"""The three classes of motion control side by side, in flight: follow a path, track a trajectory, hold a point."""

from __future__ import annotations

import numpy as np
import pytest
from support.flights import FORCES_ONLY
from support.places import CUBE, MODELS, SCENARIOS
from support.scenario_files import MINIMAL, mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.scenario import load


def flown(folder, name, changes, duration):
    changes = {"checks": FORCES_ONLY, "duration_s": duration, **changes}
    return cube_sim.run(SCENARIOS / f"{name}.yaml", changes, out=folder / "out").signals


@pytest.fixture(scope="module")
def held_back(tmp_path_factory):
    """Both laws on the helix, from 5 m behind its first point, for 40 s."""
    start = {"initial.position_m": [3.0, -5.0, -8.0]}
    folder = tmp_path_factory.mktemp("held_back")
    return {
        law: flown(folder, "cube_track", {**start, "guidance.law": law}, 40)
        for law in ("path_following", "trajectory_tracking")
    }


@pytest.mark.flight
def test_a_tracker_that_starts_behind_rushes_saturates_and_overshoots_a_follower_does_not(held_back):
    """The textbook difference (report, section 2): a trajectory does not wait, a path does."""
    speed, force, missed, overshoot = {}, {}, {}, {}
    for law, signals in held_back.items():
        speed[law] = np.linalg.norm(signals["velocity.linear"][:, 1:], axis=1).max()
        force[law] = np.abs(signals["thrusters.force_demanded"][:, 1:]).max()
        missed[law] = np.count_nonzero(signals["allocation.status"][:, 1])
        overshoot[law] = signals["path_error.along"][:, 1].max()
    assert speed["path_following"] < 0.45  # 0.4 m/s along the path, and what it takes to come in from aside
    assert speed["trajectory_tracking"] > 0.7
    assert force["trajectory_tracking"] == pytest.approx(51.44)  # a T200's most
    assert missed["path_following"] == 0 < missed["trajectory_tracking"]
    assert overshoot["path_following"] < 0.02
    assert overshoot["trajectory_tracking"] > 0.08


@pytest.mark.flight
def test_but_the_tracker_is_there_in_time_and_the_follower_late(held_back):
    late = {law: 0.4 * 40.0 - signals["target.arc_length"][-1, 1] for law, signals in held_back.items()}
    assert late["trajectory_tracking"] == pytest.approx(0.0, abs=1e-9)
    assert late["path_following"] > 4.0
    for signals in held_back.values():
        assert signals["path_error.cross_track"][-1, 1] < 0.01


@pytest.mark.flight
def test_the_tracker_follows_a_planned_speed_without_lag(tmp_path):
    """In still water, once caught up: what is left is the 20 ms of the thrusters' lag and the tick."""
    changes = {
        "current_m_s": [0.0, 0.0, 0.0],
        "initial.position_m": [3.0, 0.0, -8.0],
        "path.turns": 0.5,
        "guidance.lateral_acceleration_m_s2": 0.03,
    }
    signals = flown(tmp_path, "cube_track", changes, 25)
    error = np.hypot(signals["path_error.along"][:, 1], signals["path_error.cross_track"][:, 1])
    assert error[800:].max() < 0.01


@pytest.mark.flight
@pytest.mark.parametrize("name", ["bluerov2_heavy", "jack"])
def test_other_vehicles_hold_a_point_too_with_the_same_gains(name, tmp_path):
    changes = {
        "model": str(MODELS / f"{name}.xml"),
        "initial.position_m": [1.0, -1.2, -5.0],
        "initial.attitude_deg": [0.0, 0.0, -120.0],
        "current_m_s": [0.1, -0.05, 0.0],
    }
    signals = flown(tmp_path, "cube_hover", changes, 30)
    for signal, limit in [("path_error.cross_track", 0.06), ("path_error.along", 0.06), ("path_error.attitude", 0.05)]:
        assert np.abs(signals[signal][1250:, 1]).max() < limit, signal


@pytest.mark.flight
def test_a_free_bluerov2_needs_half_of_what_it_needs_with_its_nose_along_the_path(tmp_path):
    """Mean |f|^2 in a cross current, once it has turned."""
    effort = {}
    for mode in ("along_path", "free"):
        signals = flown(tmp_path, "bluerov2_free", {"control.attitude": {"mode": mode}}, 30)
        effort[mode] = np.mean(np.sum(signals["thrusters.force_demanded"][1000:, 1:] ** 2, axis=1))
    assert effort["free"] < 0.6 * effort["along_path"]


POINT = "{type: point, position_m: [0, 0, -5]}"


def test_a_point_path_is_held_whatever_else_the_guidance_block_says(tmp_path):
    text = MINIMAL.replace("{type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}", POINT)
    text = text.replace("hull.xml", str(CUBE))
    for extra in (
        "",
        ", stop_at_end: false",
        ", lateral_acceleration_m_s2: 0.1",
        ", law: trajectory_tracking, stop_at_end: false",
    ):
        mission = prepare(load(write(tmp_path, text.replace("0.4}", f"0.4{extra}}}"))))
        view = mission.controller.target.view(np.array([1.0, 0.0, -5.0]), np.ones(3))
        assert (view.speed, view.remaining) == (0.0, 0.0)
        wanted = mission.controller.approach.motion(view)
        np.testing.assert_allclose(wanted.velocity, [-0.4 * np.tanh(1.0 / 0.8), 0.0, 0.0], atol=1e-12)
        assert np.all(np.isfinite(wanted.acceleration))


def test_a_planar_law_refuses_points_and_clocks(tmp_path):
    scenario = SCENARIOS / "infante_line.yaml"
    with pytest.raises(ScenarioError, match="path: a planar law steers by moving ahead and cannot stay at a point"):
        prepare(load(scenario, {"path": {"type": "point", "position_m": [0.0, 0.0, -5.0]}, "checks": FORCES_ONLY}))
    with pytest.raises(ScenarioError, match=r"guidance\.law: a planar law follows paths, its target waits"):
        prepare(load(scenario, {"guidance.law": "trajectory_tracking"}))


def test_an_axis_to_look_along_needs_a_direction(tmp_path):
    look = "control: {attitude: {mode: look_at, point_m: [1, 0, 0], axis: [0, 0, 0]}}\n"
    assert mistakes(write(tmp_path, MINIMAL + look)) == [
        "mission.yaml:9:63: control.attitude.axis: an axis to look along needs a direction"
    ]
