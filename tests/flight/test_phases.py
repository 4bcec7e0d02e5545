"""Phases: the legs of a mission, each flown until it is over, in both loops the same."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import CUBE, HELIX, SCENARIOS
from support.scenario_files import mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight
from cube_sim.mission import prepare
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.replay import replay
from cube_sim.scenario import load

SURVEY = SCENARIOS / "cube_waypoints.yaml"
HERE = [0.0, 0.0, -5.0]
TEXT = f"""\
schema_version: 1
name: legs
model: {CUBE}
duration_s: 60
initial: {{position_m: [0, 0, -5]}}
guidance: {{speed_m_s: 0.4}}
checks: [{{kind: allowed_forces}}]
"""
THERE = {"name": "there", "path": {"type": "line", "start_m": HERE, "end_m": [3, 0, -5]}, "reach_m": 0.3}
TURN = {
    "name": "turn",
    "path": {"type": "point", "position_m": [3, 0, -5], "heading_deg": 90.0},
    "within_deg": 3.0,
    "hold_s": 1.0,
}
REST = {"name": "rest", "path": {"type": "point", "position_m": [3, 0, -5], "heading_deg": 90.0}, "for_s": 4.0}
DOWN = {
    "name": "down",
    "path": {"type": "line", "start_m": [3, 0, -5], "end_m": [3, 0, -7]},
    "guidance": {"speed_m_s": 0.2},
    "attitude": {"mode": "fixed", "attitude_deg": [0.0, 0.0, 90.0]},
}
LEGS = [THERE, TURN, REST, DOWN]


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    flight = Flight(write(tmp_path_factory.mktemp("legs"), TEXT), {"phases": LEGS, "stop": [{"kind": "phases_end"}]})
    flight.fly_to_its_end()
    return flight


def begins(flight):
    """When each phase begins [s]."""
    rows = flight.signals["phase.index"]
    assert rows[:, 1].tolist() == list(range(len(rows)))
    return rows[:, 0]


def row(flight, signal, t):
    rows = flight.signals[signal]
    return rows[np.argmin(np.abs(rows[:, 0] - t)), 1:]


@pytest.mark.flight
def test_each_phase_lasts_until_it_is_over(flown):
    start = begins(flown)
    assert len(start) == 4
    off = np.linalg.norm(flown.signals["pose.position"][:, 1:] - [3, 0, -5], axis=1)
    t = flown.signals["pose.position"][:, 0]
    left = flown.signals["target.remaining"][:, 1] + np.linalg.norm(
        flown.signals["target.position"][:, 1:] - flown.signals["pose.position"][:, 1:], axis=1
    )
    assert start[1] == t[np.argmax(left < 0.3)]
    arrived = (off < 0.5) & (flown.signals["path_error.attitude"][:, 1] <= np.radians(3.0))
    inside = (t > start[1]) & (t <= start[2])
    assert arrived[inside][-51:].all()
    assert not arrived[inside][-52]
    assert start[3] == pytest.approx(start[2] + 4.0, abs=1e-9)
    assert flown.time_s < 60.0
    assert np.linalg.norm(row(flown, "pose.position", 99.0) - [3, 0, -7]) < 0.5


@pytest.mark.flight
def test_a_phase_has_its_speed_and_attitude(flown):
    start = begins(flown)
    assert np.linalg.norm(row(flown, "velocity.linear", start[1] - 3.0)) == pytest.approx(0.4, abs=0.02)
    assert np.linalg.norm(row(flown, "velocity.linear", start[3] + 4.0)) == pytest.approx(0.2, abs=0.02)
    w, *_, z = row(flown, "pose.quaternion", start[3] + 4.0)
    assert 2.0 * np.degrees(np.arctan2(z, w)) == pytest.approx(90.0, abs=2.0)


@pytest.mark.flight
def test_the_log_says_when_a_phase_begins(flown):
    told = [line for line in flown.log if line.text.startswith("phase ")]
    names = ["1 of 4: there", "2 of 4: turn", "3 of 4: rest", "4 of 4: down"]
    assert [line.text for line in told] == [f"phase {name}" for name in names]
    assert [line.t for line in told] == pytest.approx(begins(flown).tolist(), abs=1e-9)
    assert flown.stopped.verdict == "PASS"


@pytest.mark.flight
def test_both_loops_fly_the_same_phases(tmp_path, monkeypatch):
    settings = {"phases": LEGS, "duration_s": 40.0, "current_m_s": [0.1, 0.05, 0.0], "navigation": {"position": {}}}
    assert assert_same_flight(write(tmp_path, TEXT), settings, monkeypatch) > 0.8
    assert_same_flight(SURVEY, {}, monkeypatch)


@pytest.mark.flight
def test_what_is_known_of_the_water_is_kept(tmp_path):
    settings = {"phases": LEGS, "current_m_s": [0.0, 0.15, 0.0], "duration_s": 40.0}
    flight = Flight(write(tmp_path, TEXT), settings)
    flight.fly_to_its_end()
    t = begins(flight)[1]
    before, after = row(flight, "water.estimated", t - 0.02), row(flight, "water.estimated", t + 0.02)
    assert after == pytest.approx(before, abs=5e-3)
    assert before[1] > 0.1


@pytest.mark.flight
def test_a_snapshot_stands_in_its_phase(flown, tmp_path):
    settings = {"phases": LEGS, "stop": [{"kind": "phases_end"}]}
    path = write(tmp_path, TEXT)
    one, other = Flight(path, settings), Flight(path, settings)
    one.fly(int(begins(flown)[2] / 0.02) + 50)
    other.restore(one.snapshot())
    other.fly_to_its_end()
    assert other.time_s == flown.time_s
    last = flown.signals["pose.position"][:, 0] > begins(flown)[2] + 2.0
    assert (other.signals["pose.position"][-last.sum() :] == flown.signals["pose.position"][last]).all()
    other.reset()
    other.fly_to_its_end()
    assert other.signals["pose.position"].tobytes() == flown.signals["pose.position"].tobytes()


@pytest.mark.flight
def test_a_record_flies_its_phases_again(tmp_path):
    result = cube_sim.run(SURVEY, out=tmp_path / "run")
    assert result.verdict == "PASS"
    run = load_run(tmp_path / "run")
    assert replay(run).identical
    assert run.fields["phase.index"].labels == ("first line", "second line", "second line: hold", "way back")
    again = load(tmp_path / "run" / "resolved.yaml").scenario
    assert again.phases == load(SURVEY).scenario.phases
    assert again.waypoints == ()


@pytest.mark.flight
def test_one_phase_flies_as_its_path_alone(tmp_path):
    path = write(tmp_path, TEXT)
    alone = Flight(path, {"path": THERE["path"], "duration_s": 6.0})
    phased = Flight(path, {"phases": [THERE], "duration_s": 6.0})
    for flight in (alone, phased):
        flight.fly_to_its_end()
    assert {name for name in phased.signals if name not in alone.signals} == {"phase.index"}
    for name, rows in alone.signals.items():
        if name != "path.points":
            assert rows.tobytes() == phased.signals[name].tobytes(), name


def test_another_law_flies_no_phases():
    path = {"type": "line", "start_m": [0, 0, -5], "end_m": [50, 0, -5]}
    phases = [{"name": "leg", "path": path, "guidance": {"speed_m_s": 1.5}}]
    scenario = load(SCENARIOS / "infante_line.yaml").scenario
    phases[0]["path"] = scenario.path.model_dump(mode="json")
    with pytest.raises(ScenarioError, match="only the law for all axes"):
        prepare(load(SCENARIOS / "infante_line.yaml", {"phases": phases}))


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("waypoints: [{to_m: [1, 2]}]", "8:14: waypoints.0.to_m.2: a number is missing"),
        ("waypoints: [{to_m: [1, 2, -5], speed_m_s: -1}]", "8:43: waypoints.0.speed_m_s: must be"),
        ("phases: [{name: a, path: {type: line, start_m: [0, 0, 0]}}]", "phases.0.path.end_m: this key is required"),
        ("phases: [{name: a, path: {type: point}, guidance: {speed: 1}}]", "phases.0.guidance.speed: unknown key"),
    ],
)
def test_mistakes_in_phases_stand_where_they_are_written(more, expected, tmp_path):
    found = mistakes(write(tmp_path, TEXT + more + "\n"))
    assert any(expected in line for line in found), found
    assert all("mission.yaml:8:" in line for line in found)


def test_a_path_beside_phases_is_refused():
    with pytest.raises(ScenarioError, match="the path is that of the first phase"):
        load(HELIX, {"phases": [THERE]})
