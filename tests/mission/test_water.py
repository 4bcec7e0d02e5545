"""A scenario's current by depth and over time: the water that is asked for, and how it takes a hull along."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import CUBE
from support.scenario_files import MINIMAL, mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.mission import prepare
from cube_sim.mission.water import water_schedule
from cube_sim.scenario import load
from cube_sim.vehicle.current import water_velocity

PROFILE = {"depths_m": [0, 4, 10], "velocities_m_s": [[0.3, 0, 0], [0.1, 0.2, 0], [0, 0, 0]]}
DRIFT = f"""\
schema_version: 1
name: drift
model: {CUBE}
duration_s: 12
path: {{type: point, position_m: [0, 0, -5]}}
initial: {{position_m: [0, 0, -5]}}
guidance: {{speed_m_s: 0.4}}
checks: [{{kind: allowed_forces}}]
"""
DEAD = {
    "kind": "thrusters",
    "at_s": 0,
    "state": "dead",
    "thrusters": [f"T{i}" for i in range(1, 9)],
}


def water_at(folder, events, times, height=-5.0, **others):
    """The water [m/s] that the events make at some times, each once those due by then are carried out."""
    scenario = load(write(folder, DRIFT), {"events": events, "duration_s": 100.0, **others})
    mission, found = prepare(scenario), []
    for t in times:
        mission.events.apply_due(t)
        found.append(water_velocity(mission.model, t, height))
    return np.array(found)


def test_a_profile_is_linear_between_its_depths_and_still_beyond_them(tmp_path):
    mission = prepare(load(write(tmp_path, DRIFT), {"current_profile": PROFILE}))
    expected = {-1: [0.3, 0, 0], 0: [0.3, 0, 0], 1: [0.25, 0.05, 0], 7: [0.05, 0.1, 0], 99: [0, 0, 0]}
    for depth, velocity in expected.items():
        assert water_velocity(mission.model, 3.0, -depth) == pytest.approx(velocity, abs=1e-15)


def test_a_ramp_begins_at_what_was_before_and_stays(tmp_path):
    events = [{"kind": "current", "at_s": 10, "over_s": 20, "current_m_s": [0.4, -0.2, 0]}]
    found = water_at(tmp_path, events, [0, 10, 15, 20, 30, 99], current_m_s=[0.0, 0.2, 0.0])
    expected = [[0, 0.2, 0], [0, 0.2, 0], [0.1, 0.1, 0], [0.2, 0, 0], [0.4, -0.2, 0], [0.4, -0.2, 0]]
    assert found == pytest.approx(np.array(expected), abs=1e-14)


def test_a_ramp_takes_over_from_one_that_is_under_way_and_a_step_from_either(tmp_path):
    events = [
        {"kind": "current", "at_s": 10, "over_s": 20, "current_m_s": [0.4, 0, 0]},
        {"kind": "current", "at_s": 20, "over_s": 10, "profile": PROFILE},
        {"kind": "current", "at_s": 25, "current_m_s": [0, 0, 0.1]},
        {"kind": "current", "at_s": 40, "over_s": 10, "current_m_s": [0, 0, 0]},
    ]
    found = water_at(tmp_path, events, [20, 22.5, 25, 30, 45, 50, 60], height=-4.0)
    expected = [[0.2, 0, 0], [0.175, 0.05, 0], [0, 0, 0.1], [0, 0, 0.1], [0, 0, 0.05], [0, 0, 0], [0, 0, 0]]
    assert found == pytest.approx(np.array(expected), abs=1e-14)


def test_a_current_that_changes_at_once_needs_no_table(tmp_path):
    text = DRIFT + "events: [{kind: current, at_s: 1, current_m_s: [0, 0.1, 0]}]\n"
    assert water_schedule(load(write(tmp_path, text)).scenario) is None


@pytest.mark.flight
@pytest.mark.parametrize(("integrator", "off_m_s"), [("RK4", 1e-7), ("implicitfast", 1e-3)])
def test_water_that_sets_in_takes_a_hull_along_by_its_acceleration(integrator, off_m_s, tmp_path):
    """A neutral hull at rest relative to the water stays so: the water pushes it by all that its own mass takes.

    (M + M_A) v' = (M_A + rho V) v_c' with M = rho V.
    """
    events = [DEAD, {"kind": "current", "at_s": 3.005, "over_s": 4.0, "current_m_s": [0.4, -0.2, 0.0]}]
    settings = {"events": events, "physics.integrator": integrator, "control_period_s": 0.1}
    settings["parameters"] = {"hull:centre_of_buoyancy": [0.0, 0.0, 0.0]}  # nothing turns it
    run = cube_sim.run(write(tmp_path, DRIFT), settings, record="none")
    velocity, water = run.signals["velocity.linear"], run.signals["water.current"]
    late = velocity[:, 0] > 8
    assert water[late, 1:] == pytest.approx(np.tile([0.4, -0.2, 0.0], (late.sum(), 1)))
    assert velocity[late, 1:] == pytest.approx(water[late, 1:], abs=off_m_s)
    amid = (velocity[:, 0] > 3.2) & (velocity[:, 0] < 6.8)
    assert velocity[amid, 1:] == pytest.approx(water[amid, 1:], abs=off_m_s)


@pytest.mark.flight
def test_water_that_changes_at_once_does_not_push(tmp_path):
    """Then only drag takes the hull along, which is slow."""
    events = [DEAD, {"kind": "current", "at_s": 3.0, "current_m_s": [0.4, 0.0, 0.0]}]
    velocity = cube_sim.run(write(tmp_path, DRIFT), {"events": events}, record="none").signals["velocity.linear"]
    assert 0.0 < velocity[velocity[:, 0] > 3.2][0, 1] < 0.05


@pytest.mark.flight
def test_both_loops_drift_the_same(tmp_path, monkeypatch):
    events = [
        {"kind": "current", "at_s": 1.003, "over_s": 2.0, "profile": PROFILE},
        {"kind": "current", "at_s": 4, "current_m_s": [0, 0.1, 0]},
        {"kind": "current", "at_s": 5, "over_s": 2.5, "current_m_s": [0.2, 0, 0]},
    ]
    settings = {"events": events, "duration_s": 10.0, "current_profile": PROFILE}
    assert assert_same_flight(write(tmp_path, DRIFT), settings, monkeypatch) > 0.9


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("current_profile: {depths_m: [0, 5, 5], velocities_m_s: [[0,0,0],[0,0,0],[0,0,0]]}",
         "9:36: current_profile.depths_m.2: depths must increase: 5 m comes after 5 m"),
        ("current_profile: {depths_m: [0, 5], velocities_m_s: [[0,0,0]]}",
         "9:53: current_profile.velocities_m_s: 1 velocities for 2 depths"),
        ("events: [{kind: current, at_s: 1}]", "events.0.current_m_s: give either current_m_s or profile"),
    ],
)  # fmt: skip
def test_what_is_no_current_is_refused_in_place(line, expected, tmp_path):
    (found,) = mistakes(write(tmp_path, MINIMAL + line + "\n"))
    assert expected in found


def test_two_currents_at_the_start_are_refused(tmp_path):
    found = mistakes(write(tmp_path, DRIFT), {"current_profile": PROFILE, "current_m_s": [0.1, 0, 0]})
    assert found == ["override current_profile: give either current_m_s or current_profile"]


def test_a_model_with_a_table_of_its_own_is_refused(tmp_path):
    table = {"water:current": [0, 0, 0.1, 0, 0, 9, 0, 0.2, 0, 0]}
    loaded = load(write(tmp_path, DRIFT), {"parameters": table, "current_profile": PROFILE})
    with pytest.raises(ScenarioError, match="override current_profile: the model has a current of its own"):
        prepare(loaded)
