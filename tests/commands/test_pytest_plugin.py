"""The pytest plugin in a pytest of its own: one test per scenario file, its text the table or the mistakes.

Its own process, too: pytester forgets the modules an inner pytest has imported, and native code loads only once.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest
from support.scenario_files import FLIGHT

pytest_plugins = ["pytester"]

DEAD = "events: [{kind: thrusters, at_s: 0.2, thrusters: [T1], state: dead}]\nchecks:"
FAILING = FLIGHT.replace("at_most: 0.05", "at_most: -1").replace("short_flight", "too_strict").replace("checks:", DEAD)
MISNAMED = FLIGHT.replace("path_error.cross_track", "path_error.crosstrack").replace("short_flight", "misnamed")
THROWN = "initial: {velocity_m_s: [1e5, 0, 0], position_m:"
UNJUDGED = FLIGHT.replace("initial: {position_m:", THROWN).replace("short_flight", "thrown")
WRONG = FLIGHT.replace("duration_s", "durtion_s").replace("kind: allowed_forces", "kind: allowed_force")


@pytest.fixture
def folder(pytester):
    scenarios = pytester.mkdir("scenarios")
    for name, text in (
        ("short_flight.yaml", FLIGHT),
        ("too_strict.yaml", FAILING),
        ("misnamed.yaml", MISNAMED),
        ("thrown.yaml", UNJUDGED),
        ("wrong.yaml", WRONG),
        ("scenario.schema.json", "{}"),
    ):
        (scenarios / name).write_text(text)
    elsewhere = pytester.mkdir("data")
    (elsewhere / "table.yaml").write_text("not: a scenario\n")
    return pytester


def test_one_test_per_scenario_file_and_none_for_other_files(folder):
    result = folder.runpytest_subprocess(f"--rootdir={folder.path}", "-p", "cube_sim.testing", "--collect-only", "-q")
    assert sorted(line for line in result.outlines if "::" in line) == [
        "scenarios/misnamed.yaml::misnamed",
        "scenarios/short_flight.yaml::short_flight",
        "scenarios/thrown.yaml::thrown",
        "scenarios/too_strict.yaml::too_strict",
        "scenarios/wrong.yaml::wrong",
    ]
    assert result.ret == 0


def test_a_quick_look_leaves_flights_out_in_a_repository_that_has_not_heard_of_the_marker(folder):
    result = folder.runpytest_subprocess(
        "-p", "cube_sim.testing", "--strict-markers", "-m", "not flight", "--collect-only", "-q"
    )
    assert "no tests collected (5 deselected)" in result.stdout.str()


@pytest.mark.flight
def test_outcomes_texts_properties_and_recordings(folder):
    report, base = folder.path / "report.xml", folder.path / "recordings"
    result = folder.runpytest_subprocess("-p", "cube_sim.testing", f"--junitxml={report}", f"--basetemp={base}", "-ra")
    result.assert_outcomes(passed=1, failed=4)
    text = result.stdout.str()
    assert "Traceback" not in text
    assert "testing.py" not in text

    cases = {case.get("name"): case for case in ElementTree.parse(report).iter("testcase")}
    failures = {name: case.find("failure").text for name, case in cases.items() if case.find("failure") is not None}
    assert sorted(failures) == ["misnamed", "thrown", "too_strict", "wrong"]
    path = folder.path / "scenarios" / "wrong.yaml"
    assert failures["wrong"].splitlines() == [
        f"{path}:4:1: durtion_s: unknown key; did you mean duration_s?",
        f"{path}:10:5: checks.1: unknown kind 'allowed_force'; did you mean allowed_forces?",
    ]
    assert failures["too_strict"].startswith("FAIL  too_strict.yaml")
    assert "thruster forces inside their allowed sets" in failures["too_strict"]
    assert failures["thrown"].startswith("ERROR  thrown.yaml")
    thrown = " ".join(failures["thrown"].split())
    assert "path_error.cross_track holds no samples" in thrown
    assert "ended early, at 0 s: the acceleration of 'hull' is" in thrown
    assert "0 of 0.5 s simulated" in thrown
    assert "log:\n  0.00 s  ERROR  the acceleration of 'hull' is" in failures["thrown"]
    assert failures["too_strict"].endswith("\n\nlog:\n  0.20 s  WARNING  T1: dead")
    assert failures["misnamed"] == (
        f"{path.with_name('misnamed.yaml')}:9:28: checks.0.signal: no signal 'path_error.crosstrack' is recorded, "
        "did you mean path_error.cross_track?"
    )

    properties = {
        name: {item.get("name"): item.get("value") for item in case.iter("property")} for name, case in cases.items()
    }
    assert properties["short_flight"]["verdict"] == "PASS"
    assert 0.0 <= float(properties["short_flight"]["max of path_error.cross_track"]) < 0.05
    assert properties["too_strict"]["verdict"] == "FAIL"
    assert properties["wrong"] == {}
    assert properties["too_strict"]["log"] == "0.20 s  WARNING  T1: dead"
    assert properties["thrown"]["ended_early"].startswith("ended early, at 0 s: the acceleration of 'hull' is")
    assert {"log", "ended_early"}.isdisjoint(properties["short_flight"])

    # Each flight has left its recording where pytest keeps temporary files, and nowhere else.
    recordings = sorted(file.relative_to(base).parts[0] for file in base.rglob("run.mcap"))
    assert recordings == ["short_flight0", "thrown0", "too_strict0"]
    assert not (folder.path / "logs").exists()


@pytest.mark.flight
def test_an_unforeseen_error_keeps_its_traceback(folder):
    folder.makeconftest(
        """
        import sys, types

        def broken(*_, **__):
            raise ZeroDivisionError("a bug")

        sys.modules["cube_sim.simulation"] = types.SimpleNamespace(fly=broken)
        """
    )
    result = folder.runpytest_subprocess("-p", "cube_sim.testing", "scenarios/short_flight.yaml")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*testing.py*", "*ZeroDivisionError: a bug*"])
