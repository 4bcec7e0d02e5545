"""The pytest plugin in a pytest of its own: one test per scenario file, its text the table or the mistakes.

Its own process, too: pytester forgets the modules an inner pytest has imported, and native code loads only once.
"""

from __future__ import annotations

import re
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


SAMPLED = FLIGHT.replace(
    "checks:",
    "samples: {count: 4, vary: {initial.position_m.1: {distribution: grid, values: [0, 0.01, 0.5, 0.6]}}}\nchecks:",
).replace("short_flight", "sampled")


def collected(folder, *arguments):
    """The tests there are, and all that was said."""
    result = folder.runpytest_subprocess("-p", "cube_sim.testing", "--collect-only", "-q", *arguments)
    return sorted(line for line in result.outlines if "::" in line), result


def test_one_test_per_scenario_file_and_none_for_other_files(folder):
    names, result = collected(folder, f"--rootdir={folder.path}")
    assert names == [
        "scenarios/misnamed.yaml::misnamed",
        "scenarios/short_flight.yaml::short_flight",
        "scenarios/thrown.yaml::thrown",
        "scenarios/too_strict.yaml::too_strict",
        "scenarios/wrong.yaml::wrong",
    ]
    assert result.ret == 0


def test_files_are_scenarios_by_what_they_hold_in_folders_of_any_name(folder):
    deep = folder.path / "flights" / "of" / "today"
    deep.mkdir(parents=True)
    (deep / "b.yml").write_text(FLIGHT)
    workflows = folder.path / "pipelines"
    workflows.mkdir()
    (workflows / "ci.yml").write_text("on: [push]\njobs: {}\n")
    (workflows / "unreadable.yaml").write_bytes(b"a: [1\n\xff\xfe\x00")
    run = folder.path / "logs" / "run"
    run.mkdir(parents=True)
    (run / "resolved.yaml").write_text(FLIGHT)
    (run / "verdict.json").write_text("{}")
    names, result = collected(folder)
    assert "flights/of/today/b.yml::b" in names
    assert len(names) == 6
    said = "skipped, they hold no scenario: data/table.yaml, pipelines/ci.yml, pipelines/unreadable.yaml"
    assert result.outlines.count(said) == 1
    assert collected(folder, "flights")[0] == ["flights/of/today/b.yml::b"]
    # Whoever names a file means it.
    assert collected(folder, "pipelines/ci.yml")[0] == ["pipelines/ci.yml::ci"]


def test_where_there_are_no_scenarios_nothing_is_said(pytester):
    (pytester.path / "compose.yml").write_text("services: {}\n")
    (pytester.path / "test_x.py").write_text("def test_x(): pass\n")
    names, result = collected(pytester)
    assert names == ["test_x.py::test_x"]
    assert "compose.yml" not in result.stdout.str()


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        ((), ["s0", "s1", "s2", "s3"]),
        (("--scenario-samples", "first:2"), ["s0", "s1"]),
        (("--scenario-samples", "2"), ["s2"]),
        (("--scenario-samples", "all"), ["s0", "s1", "s2", "s3"]),
        (("--scenario-samples", "1-2,7"), ["s1", "s2"]),
        (("--scenario-samples", "first:1", "-k", "s0 or s3"), ["s0"]),
        (("--scenario-samples", "first:0", "sampled.yaml::sampled[s3]"), ["s3"]),
        (("--scenario-samples", "first:1", "--scenario-seed", "7", "--scenario-seed", "8"), ["s0-seed7", "s0-seed8"]),
    ],
)
def test_samples_and_seeds_are_tests_of_their_own(pytester, arguments, names):
    (pytester.path / "sampled.yaml").write_text(SAMPLED)
    found, result = collected(pytester, *arguments)
    assert found == [f"sampled.yaml::sampled[{name}]" for name in names]
    left_out = "samples are tests (--scenario-samples)" in result.stdout.str()
    assert left_out is (len(names) < 4)


@pytest.mark.parametrize(
    ("required", "arguments", "names"),
    [
        ("pass_rate: 0.5", (), []),
        ("pass_rate: 0.5", ("--scenario-samples", "first:2"), ["s0", "s1"]),
        ("pass_rate: 0.5", ("sampled.yaml::sampled[s3]",), ["s3"]),
        ("confidence: 0.9", (), ["s0", "s1", "s2", "s3"]),
    ],
)
def test_samples_of_which_a_share_may_fail_are_no_tests_unless_asked_for(pytester, required, arguments, names):
    text = SAMPLED.replace("samples: {", f"samples: {{required: {{{required}}}, ")
    (pytester.path / "sampled.yaml").write_text(text)
    found, result = collected(pytester, *arguments)
    assert found == [f"sampled.yaml::sampled[{name}]" for name in names]
    left_out = "samples are tests (--scenario-samples), cube-sim sweep judges the pass rate that they must show"
    assert (left_out in result.stdout.str()) is (len(names) < 4)


def test_options_that_mean_nothing_are_told_at_once(folder):
    for arguments, told in (
        (("--scenario-set", "duration_s"), "--set duration_s: write PATH=VALUE"),
        (
            ("--scenario-samples", "some"),
            "--scenario-samples some: all, first:N, or numbers from 0, for example 0-9,17",
        ),
        (("--scenario-samples", "first:"), "--scenario-samples first:: all, first:N"),
    ):
        result = folder.runpytest_subprocess("-p", "cube_sim.testing", *arguments)
        assert result.ret == pytest.ExitCode.USAGE_ERROR
        assert told in result.stderr.str()


@pytest.mark.flight
@pytest.mark.parametrize("processes", [0, 2])
def test_overrides_folders_and_what_is_kept(pytester, processes):
    """With and without pytest-xdist."""
    (pytester.path / "sampled.yaml").write_text(SAMPLED)
    (pytester.path / "other.yml").write_text("on: push\n")
    report, out = pytester.path / "report.xml", pytester.path / "out"
    options = ("--scenario-out", out, "--scenario-keep", "failures", "--scenario-set", "guidance.speed_m_s=0.3")
    with_xdist = ("-p", "xdist", "-n", str(processes)) if processes else ()
    result = pytester.runpytest_subprocess(
        "-p", "cube_sim.testing", f"--junitxml={report}", *map(str, options), *with_xdist
    )
    result.assert_outcomes(passed=2, failed=2)
    assert result.outlines.count("skipped, they hold no scenario: other.yml") == 1
    assert sorted(path.name for path in out.iterdir()) == ["sampled-s2", "sampled-s3"]
    assert (out / "sampled-s2" / "run.mcap").is_file()
    assert "speed_m_s: 0.3" in (out / "sampled-s2" / "resolved.yaml").read_text()
    cases = {case.get("name"): case for case in ElementTree.parse(report).iter("testcase")}
    said = cases["sampled[s3]"].find("failure").text
    assert said.splitlines()[-1] == "again: cube-sim run sampled.yaml --sample 3 --set guidance.speed_m_s=0.3"
    properties = {item.get("name"): item.get("value") for item in cases["sampled[s1]"].iter("property")}
    assert properties["drawn initial.position_m.1"] == "0.01"
    assert properties["verdict"] == "PASS"


@pytest.mark.flight
def test_without_recordings_there_is_a_verdict_alone(pytester):
    (pytester.path / "a.yaml").write_text(FLIGHT)
    out = pytester.path / "out"
    result = pytester.runpytest_subprocess(
        "-p", "cube_sim.testing", "--scenario-out", str(out), "--scenario-keep", "none", "--scenario-seed", "3"
    )
    result.assert_outcomes(passed=1)
    assert sorted(path.name for path in (out / "a-seed3").iterdir()) == ["resolved.yaml", "verdict.json"]
    assert "seed: 3" in (out / "a-seed3" / "resolved.yaml").read_text()


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
        f"{path}:10:12: checks.1.kind: unknown kind 'allowed_force'; did you mean allowed_forces?",
    ]
    assert failures["too_strict"].startswith("FAIL  too_strict.yaml")
    assert "thruster forces inside their allowed sets" in failures["too_strict"]
    assert failures["thrown"].startswith("ERROR  thrown.yaml")
    thrown = " ".join(failures["thrown"].split())
    assert "path_error.cross_track holds no samples" in thrown
    assert "ended early, at 0 s: the acceleration of 'hull' is" in thrown
    assert "0 of 0.5 s simulated" in thrown
    assert "log:\n  0.00 s  ERROR  the acceleration of 'hull' is" in failures["thrown"]
    again = "again: cube-sim run scenarios/too_strict.yaml"
    assert failures["too_strict"].endswith(f"\n\nlog:\n  0.20 s  WARNING  T1: dead\n\n{again}")
    assert failures["misnamed"] == (
        f"{path.with_name('misnamed.yaml')}:9:28: checks.0.signal: no signal 'path_error.crosstrack' is recorded, "
        "did you mean path_error.cross_track?"
    )

    properties = {
        name: {item.get("name"): item.get("value") for item in case.iter("property")} for name, case in cases.items()
    }
    assert properties["short_flight"]["verdict"] == "PASS"
    assert 0.0 <= float(properties["short_flight"]["max of path_error.cross_track"]) < 0.05
    judged = properties["short_flight"]["max of path_error.cross_track: judged"]
    assert re.fullmatch(r"PASS: <= 0.05 m, margin \S+ m at \S+ s; 26 samples of path_error.cross_track, .*", judged)
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
