"""Phases: the legs of a mission, each flown until it is over, in both loops the same."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import CUBE, HELIX, MODELS, REPO, SCENARIOS
from support.scenario_files import mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight
from cube_sim.mission import prepare
from cube_sim.report.subject import Subject
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.replay import replay
from cube_sim.scenario import load
from cube_sim.scenario.document import parse

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


def planar_legs(*corners, **guidance):
    """Lines from corner to corner of a level course."""
    return [
        {
            "name": f"leg {i + 1}",
            "path": {"type": "line", "start_m": [*start, -10.0], "end_m": [*end, -10.0]},
            "guidance": guidance if i else {},
            "reach_m": 3.0,
        }
        for i, (start, end) in enumerate(pairwise(corners))
    ]


COURSE = planar_legs([0.0, 0.0], [60.0, 0.0], [60.0, 80.0], [0.0, 80.0], speed_m_s=1.2)
PLANAR = {"duration_s": 240.0, "phases": COURSE, "stop": [{"kind": "phases_end"}], "initial.position_m": [0, 0, -10]}


@pytest.fixture(scope="module")
def infante(tmp_path_factory):
    text = (SCENARIOS / "infante_line_current.yaml").read_text()
    text = text.replace("../models", str(MODELS))
    data = parse(text).data
    data.pop("path")
    data |= {"checks": [{"kind": "allowed_forces"}]}
    path = tmp_path_factory.mktemp("planar") / "mission.yaml"
    path.write_text(json.dumps(data))
    return path


@pytest.mark.flight
def test_the_planar_law_flies_phases_in_both_loops(infante, monkeypatch):
    assert assert_same_flight(infante, PLANAR, monkeypatch) > 0.8
    flight = Flight(infante, PLANAR)
    flight.fly_to_its_end()
    start = begins(flight)
    assert len(start) == 3
    assert flight.stopped.verdict == "PASS"
    for end, speed in zip([*start[1:], flight.time_s], (1.5, 1.2, 1.2), strict=True):
        assert row(flight, "path_error.cross_track", end - 0.5)[0] < 0.15
        assert row(flight, "velocity.linear", end - 0.5)[0] == pytest.approx(speed, abs=0.25)
    before, after = (row(flight, "water.estimated", start[1] + by) for by in (-0.1, 0.2))
    assert after == pytest.approx(before, abs=0.02)
    assert np.linalg.norm(before) > 0.1


def test_what_the_planar_law_cannot_fly_is_refused_at_its_phase(infante):
    held = {"name": "held", "path": {"type": "point", "position_m": [60, 0, -10]}}
    with pytest.raises(ScenarioError, match=r"override phases: phases.1.path: a planar law .* cannot stay at a point"):
        prepare(load(infante, {**PLANAR, "phases": [COURSE[0], held]}))
    deeper = {"name": "deeper", "path": {"type": "line", "start_m": [60, 0, -12], "end_m": [60, 50, -12]}}
    with pytest.raises(ScenarioError, match=r"override phases: phases.1.path: lies at z = -12 m, the vehicle stays"):
        prepare(load(infante, {**PLANAR, "phases": [COURSE[0], deeper]}))
    turned = {**COURSE[1], "attitude": {"mode": "fixed", "attitude_deg": [0, 0, 0]}}
    with pytest.raises(ScenarioError, match=r"override phases: phases.1.attitude: the planar law has no use for it"):
        prepare(load(infante, {**PLANAR, "phases": [COURSE[0], turned]}))


@pytest.mark.flight
@pytest.mark.parametrize("law", ["own_pid.py:pid", "own_pid_compiled.py:pid"])
def test_a_law_of_ones_own_flies_phases_and_keeps_its_memory(law, tmp_path, monkeypatch):
    rest = {**REST, "path": {**REST["path"], "position_m": HERE}}
    settings = {
        "phases": [{**rest, "for_s": 12.0}, rest, {**THERE, "reach_m": 0.2}],
        "current_m_s": [0.2, 0.3, 0.0],
        "control.law": {"python": str(REPO / "examples" / law)},
        "stop": [{"kind": "phases_end"}],
    }
    path = write(tmp_path, TEXT)
    flight = Flight(path, settings)
    flight.fly_to_its_end()
    start = begins(flight)
    assert len(start) == 3
    assert flight.stopped.verdict == "PASS"
    # What the integral has learnt of the current holds on: the hull is not let go where the phase changes.
    before, after = (row(flight, "wrench.demanded", start[1] + by)[:3] for by in (0.0, 0.02))
    assert np.linalg.norm(before) > 5.0
    assert np.linalg.norm(after - before) < 0.05 * np.linalg.norm(before)
    if "compiled" in law:
        assert_same_flight(path, settings, monkeypatch)


def test_a_whole_controller_of_ones_own_is_not_asked_to_fly_phases(tmp_path):
    (tmp_path / "law.py").write_text(CONTROLLER)
    path = write(tmp_path, TEXT)
    law = {"control.law": {"python": "law.py:still"}}
    with pytest.raises(ScenarioError, match=r"phases.0.path: a controller of one's own keeps its path"):
        prepare(load(path, {**law, "phases": LEGS}))


CONTROLLER = """\
class still:
    def __init__(self, setup):
        self.target = setup.target

    def view(self, state):
        return self.target.view(state.position, state.velocity)

    def reconfigure(self, left):
        pass

    def decide(self, state, applied, dt, force_ratio=1.0):
        raise AssertionError
"""

LATE = {**THERE, "time_limit_s": 3.0}


@pytest.mark.flight
def test_a_phase_that_runs_out_of_time_is_told_and_counted(tmp_path, monkeypatch):
    path = write(tmp_path, TEXT)
    checks = [{"kind": "signal", "signal": "phase.late", "statistic": "final", "at_most": 1}]
    legs = [LATE, {**TURN, "time_limit_s": 40.0}, {**DOWN, "time_limit_s": 2.0}]
    settings = {"phases": legs, "stop": [{"kind": "phases_end"}], "checks": checks}
    assert_same_flight(path, settings, monkeypatch)
    run = cube_sim.run(path, settings, tmp_path / "run")
    assert run.signals["phase.index"][:, 1].tolist() == [0, 1, 2, 2]
    assert run.signals["phase.late"][:, 1].tolist() == [0, 1, 1, 2]
    assert run.signals["phase.index"][1, 0] == pytest.approx(3.0, abs=1e-9)
    assert run.signals["phase.index"][3, 0] == pytest.approx(run.signals["phase.index"][2, 0] + 2.0, abs=1e-9)
    told = [line.text for line in run.log if line.level == "WARNING"]
    assert told[0] == "phase 1 of 3: there: has not arrived within 3 s"
    assert told[1] == "phase 3 of 3: down: has not arrived within 2 s"
    assert (run.verdict, run.checks[0].value) == ("FAIL", 2.0)
    phases = Subject(load_run(tmp_path / "run"), "a", "#000").phases
    assert [each.name for each in phases] == ["there", "turn", "down"]


@pytest.mark.flight
def test_a_phase_that_must_not_be_late_ends_the_run(tmp_path):
    settings = {"phases": [{**LATE, "when_late": "fail"}, TURN]}
    run = cube_sim.run(write(tmp_path, TEXT), settings, tmp_path / "run")
    assert run.verdict == "FAIL"
    assert run.ended_early.time_s == pytest.approx(3.0, abs=1e-9)
    assert run.ended_early.reason == "phase 1 of 2: there: has not arrived within 3 s"
    assert run.signals["phase.late"][:, 1].tolist() == [0, 1]


@pytest.mark.flight
def test_one_that_arrives_in_time_flies_as_without_a_limit(flown, tmp_path):
    legs = [{**leg, "time_limit_s": 50.0} if "for_s" not in leg else leg for leg in LEGS]
    flight = Flight(write(tmp_path, TEXT), {"phases": legs, "stop": [{"kind": "phases_end"}]})
    flight.fly_to_its_end()
    assert flight.signals["phase.late"][:, 1].tolist() == [0, 0, 0, 0]
    for name in ("pose.position", "wrench.demanded", "phase.index"):
        assert flight.signals[name].tobytes() == flown.signals[name].tobytes()


def test_limits_that_say_nothing_are_refused(tmp_path):
    both = {"phases": [{**THERE, "for_s": 3.0, "time_limit_s": 4.0}]}
    with pytest.raises(ScenarioError, match=r"phases.0.time_limit_s: for_s ends the phase, arrived or not"):
        load(write(tmp_path, TEXT), both)
    with pytest.raises(ScenarioError, match=r"phases.0.when_late: there is no time limit to be late for"):
        load(write(tmp_path, TEXT), {"phases": [{**THERE, "when_late": "fail"}]})
    waypoints = [{"to_m": [3, 0, -5], "hold_s": 2.0, "time_limit_s": 20.0, "when_late": "fail"}]
    legs = load(write(tmp_path, TEXT), {"waypoints": waypoints}).scenario.phases
    assert [(leg.time_limit_s, leg.when_late) for leg in legs] == [(20.0, "fail"), (None, "go_on")]


@pytest.mark.flight
def test_each_vehicle_of_several_has_its_own_phases(tmp_path):
    check = {"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "at_most": 0.2}
    data = {
        **{key: value for key, value in parse(TEXT).data.items() if key not in ("checks", "initial")},
        "duration_s": 25.0,
        "vehicles": {
            "one": {
                "phases": [THERE, TURN, DOWN],
                "initial": {"position_m": HERE},
                "checks": [{**check, "phase": "there"}],
            },
            "other": {
                "waypoints": [{"name": "off", "to_m": [0, 6, -5]}, {"name": "up", "to_m": [0, 6, -4]}],
                "initial": {"position_m": [0, 3, -5]},
                "checks": [{**check, "phase": "off"}],
            },
        },
    }
    path = tmp_path / "pair.yaml"
    path.write_text(json.dumps(data))
    run = cube_sim.run(path, out=tmp_path / "run")
    assert [check.verdict for check in run.checks] == ["PASS", "PASS"]
    assert run.signals["one/phase.index"][:, 1].tolist() == [0, 1, 2]
    assert run.signals["other/phase.index"][:, 1].tolist() == [0, 1]
    assert load_run(tmp_path / "run").checks == run.checks


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
