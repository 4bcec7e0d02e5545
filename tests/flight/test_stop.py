"""Conditions that end a run before its time: when, in both loops, and what the run is worth then."""

from __future__ import annotations

import json

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.command_line import call
from support.fleets import PAIR, fly, loaded_fleet
from support.fleets import write as write_fleet
from support.places import HELIX, SCENARIOS
from support.scenario_files import FLIGHT, MINIMAL, mistakes, write

import cube_sim
from cube_sim.errors import ScenarioError
from cube_sim.flight import Flight, vehicle_loop
from cube_sim.mission import prepare
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.replay import replay
from cube_sim.scenario import load

FORCES = [{"kind": "allowed_forces"}]
DEAD = {"kind": "thrusters", "at_s": 3.0, "state": "dead", "thrusters": [f"T{i}" for i in range(1, 8)]}
RISEN = {"kind": "signal", "signal": "pose.position", "component": 2, "above": -7.0, "verdict": "pass"}
PASSED = {"kind": "signal", "signal": "target.arc_length", "above": 8.0, "for_s": 0.3, "verdict": "pass"}


def flown(stop, **settings):
    flight = Flight(HELIX, {"stop": stop, "checks": FORCES, "duration_s": 40.0, **settings})
    flight.fly_to_its_end()
    return flight


@pytest.mark.flight
def test_the_last_row_is_the_first_that_meets_the_condition():
    flight = flown([RISEN])
    z = flight.signals["pose.position"][:, 3]
    assert z[-1] > -7.0
    assert (z[:-1] <= -7.0).all()
    assert flight.time_s == flight.signals["pose.position"][-1, 0] < 40.0
    assert all(rows[-1, 0] == flight.time_s for name, rows in flight.signals.items() if name.startswith("velocity"))
    assert flight.over
    assert flight.ended_early.verdict == "PASS"
    assert flight.log[-1].text == "pose.position[2] above -7: the run ends here"


@pytest.mark.flight
def test_it_has_to_hold_without_a_break_for_its_time():
    """The speed goes up and down at the start."""
    all_of_it = Flight(HELIX, {"checks": FORCES, "duration_s": 40.0})
    all_of_it.fly_to_its_end()
    speed = np.linalg.norm(all_of_it.signals["velocity.linear"][:, 1:], axis=1)
    limit = {"above": 0.39, "for_s": 2.0, "from_s": 5.0}
    stop = {"kind": "signal", "signal": "velocity.linear", "verdict": "pass", **limit}
    flight = flown([stop])
    t = all_of_it.signals["velocity.linear"][:, 0]
    above = (speed > 0.39) & (t >= 5.0)
    runs = np.array([above[max(k - 100, 0) : k + 1].all() and k >= 100 for k in range(len(above))])
    assert flight.time_s == t[np.argmax(runs)]


@pytest.mark.flight
@pytest.mark.parametrize(
    ("scenario", "stop", "settings"),
    [
        (HELIX, RISEN, {}),
        (HELIX, {"kind": "signal", "signal": "power.motor", "below": 150.0, "for_s": 0.5, "verdict": "pass"}, {}),
        (HELIX, {"kind": "signal", "signal": "target.arc_length", "above": 0.0, "verdict": "fail"}, {}),
        (HELIX, {"kind": "path_end", "reach_m": 0.2, "for_s": 1.0}, {"path.turns": 0.25}),
        (
            HELIX,
            {"kind": "given_up"},
            {"events": [DEAD]},
        ),
        (SCENARIOS / "cube_navigated.yaml", RISEN, {}),
        (SCENARIOS / "infante_line.yaml", PASSED, {}),
    ],
    ids=["signal", "norm", "at_once", "path_end", "given_up", "navigated", "planar"],
)
def test_both_loops_stop_at_the_same_tick(scenario, stop, settings, monkeypatch):
    assert_same_flight(scenario, {"stop": [stop], "checks": FORCES, "duration_s": 40.0, **settings}, monkeypatch)
    flight = Flight(scenario, {"stop": [stop], "checks": FORCES, "duration_s": 40.0, **settings})
    flight.fly_to_its_end()
    assert flight.stopped is not None


@pytest.mark.flight
def test_it_stops_at_the_same_tick_with_files_and_without(tmp_path):
    path = write(tmp_path, FLIGHT)
    settings = {
        "duration_s": 20.0,
        "stop": [{"kind": "signal", "signal": "target.arc_length", "above": 2.0, "verdict": "pass"}],
    }
    recorded = cube_sim.run(path, settings, tmp_path / "run")
    for other in (cube_sim.run(path, settings, record="none"), cube_sim.fly_many(path, [settings])[0]):
        assert (other.simulated_s, other.ended_early) == (recorded.simulated_s, recorded.ended_early)
        assert other.verdict == recorded.verdict == "PASS"


@pytest.mark.flight
@pytest.mark.parametrize(("said", "verdict", "code"), [("pass", "PASS", 0), ("fail", "FAIL", 1)])
def test_a_run_that_stops_says_so_everywhere(said, verdict, code, tmp_path, monkeypatch, capsys):
    stop = {"kind": "signal", "name": "far enough", "signal": "target.arc_length", "above": 1.0, "verdict": said}
    text = FLIGHT.replace("duration_s: 0.5", "duration_s: 20") + f"stop: [{json.dumps(stop)}]\n"
    path = write(tmp_path, text)
    found, *_ = call(monkeypatch, capsys, "run", str(path), "--out", str(tmp_path / "run"), "--quiet")
    assert found == code
    told = json.loads((tmp_path / "run" / "verdict.json").read_text())
    assert told["verdict"] == verdict
    assert told["ended_early"]["verdict"] == verdict
    assert told["ended_early"]["reason"] == "far enough: target.arc_length above 1"
    assert [check["verdict"] for check in told["checks"]] == ["PASS", "PASS"]
    run = load_run(tmp_path / "run")
    assert (run.verdict, run.how, run.flaw) == (verdict, "stopped", "")
    assert run.ended_early.reason == told["ended_early"]["reason"]
    assert replay(run).identical
    page = tmp_path / "report.html"
    call(monkeypatch, capsys, "report", str(tmp_path / "run"), "--out", str(page))
    assert "stopped, at" in page.read_text()
    assert call(monkeypatch, capsys, "judge", str(tmp_path / "run"))[0] == code


@pytest.mark.flight
def test_a_window_that_was_not_reached_is_not_judged(tmp_path):
    checks = [{"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "from_s": 15, "at_most": 1.0}]
    settings = {
        "duration_s": 20.0,
        "checks": checks,
        "stop": [RISEN | {"signal": "target.arc_length", "component": None, "above": 1.0}],
    }
    run = cube_sim.run(write(tmp_path, FLIGHT), settings, record="none")
    assert run.verdict == "ERROR"
    assert "outside the run" in run.checks[0].detail


@pytest.mark.flight
def test_a_snapshot_knows_for_how_long_a_condition_has_held():
    settings = {"stop": [RISEN | {"for_s": 3.0}], "checks": FORCES, "duration_s": 40.0}
    flight, other = (Flight(HELIX, settings) for _ in range(2))
    flight.fly_to_its_end()
    other.fly(flight.tick - 50)
    snapshot = other.snapshot()
    third = Flight(HELIX, settings)
    third.restore(snapshot)
    third.fly_to_its_end()
    assert third.time_s == flight.time_s
    third.reset()
    assert (third.stopped, third.over) == (None, False)
    third.fly_to_its_end()
    assert third.time_s == flight.time_s


@pytest.mark.flight
@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "python"])
def test_a_vehicle_that_is_to_stop_stops_all(compiled, tmp_path, monkeypatch):
    stop = "    stop: [{kind: signal, signal: target.arc_length, above: 1.0, verdict: pass}]\n"
    loaded = loaded_fleet(write_fleet(tmp_path, PAIR.replace("  leader:\n", "  leader:\n" + stop)))
    if not compiled:
        monkeypatch.setattr(vehicle_loop, "begin_ticks", lambda *_: None)
    loop, store = fly(loaded)
    gone = store.signals["leader/target.arc_length"][:, 1]
    assert gone[-1] > 1.0
    assert (gone[:-1] <= 1.0).all()
    assert {rows[-1, 0] for name, rows in store.signals.items() if name.endswith("pose.position")} == {loop.time_s}
    assert loop.ended_early.reason == "leader: target.arc_length above 1"
    assert [line.text for line in store.lines if "the run ends" in line.text] == [
        "leader: target.arc_length above 1: the run ends here"
    ]


@pytest.mark.parametrize(
    ("stop", "expected"),
    [
        ({"kind": "signal", "signal": "pose.place", "above": 1.0, "verdict": "fail"}, "no signal 'pose.place'"),
        (
            {"kind": "signal", "signal": "pose.position", "component": 3, "above": 1.0, "verdict": "fail"},
            "columns 0 to 2",
        ),
        ({"kind": "signal", "signal": "actuation.limits", "above": 1.0, "verdict": "fail"}, "is not known to the loop"),
    ],
)
def test_what_nobody_can_watch_is_refused(stop, expected):
    with pytest.raises(ScenarioError, match=expected):
        prepare(load(HELIX, {"stop": [stop]}))


def test_two_limits_are_refused_in_place(tmp_path):
    text = MINIMAL + "stop: [{kind: signal, signal: pose.position, verdict: pass}]\n"
    (found,) = mistakes(write(tmp_path, text))
    assert found == "mission.yaml:9:8: stop.0: give exactly one limit: above or below"
