"""Several scenarios by one command: all looked at first, one table, the worst verdict's exit code."""

from __future__ import annotations

import json
import signal

import pytest
from support.command_line import call, started
from support.scenario_files import FLIGHT

FAILING = FLIGHT.replace("name: short_flight", "name: too_strict").replace(
    "[0, 0, -5]}\nguidance", "[0, 1, -5]}\nguidance"
)
UNJUDGED = FLIGHT.replace("name: short_flight", "name: thrown").replace(
    "initial: {position_m:", "initial: {velocity_m_s: [1e5, 0, 0], position_m:"
)
WRONG = FLIGHT.replace("duration_s", "durtion_s")
MISNAMED = FLIGHT.replace("path_error.cross_track", "path_error.crosstrack")


@pytest.fixture
def scenarios(tmp_path, monkeypatch):
    """Write scenarios below a folder, which is the working directory then."""
    monkeypatch.chdir(tmp_path)

    def write(**texts: str):
        for name, text in texts.items():
            file = tmp_path / "missions" / f"{name.replace('__', '/')}.yaml"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return tmp_path

    return write


@pytest.mark.flight
def test_one_table_of_all_and_the_worst_verdict(scenarios, monkeypatch, capsys):
    folder = scenarios(a=FLIGHT, b__deep=FAILING, c=UNJUDGED, d=WRONG, e=MISNAMED)
    (folder / "missions" / "workflow.yml").write_text("on: push\njobs: {}\n")
    code, stdout, stderr = call(monkeypatch, capsys, "run", "missions", "--out", "out", "--record", "mcap")
    assert code == 1
    lines = stdout.splitlines()
    assert lines[0].startswith("FAIL  1 PASS, 1 ERROR, 2 INVALID, 1 FAIL of 5 scenarios")
    rows = {line.split()[0]: line.split() for line in lines if line.startswith("missions/")}
    assert rows["missions/a.yaml"][1] == "PASS"
    assert rows["missions/a.yaml"][-3:] == ["0.5", "s", "out/short_flight"]
    assert [rows[f"missions/{name}.yaml"][1] for name in ("c", "d", "e")] == ["ERROR", "INVALID", "INVALID"]
    assert rows["missions/b/deep.yaml"][1] == "FAIL"
    assert "missions/b/deep.yaml: FAIL max of path_error.cross_track: " in " ".join(stdout.split())
    assert "skipped, they hold no scenario: missions/workflow.yml" in lines
    assert stderr.splitlines() == [
        "missions/d.yaml:4:1: durtion_s: unknown key; did you mean duration_s?",
        "missions/e.yaml:9:28: checks.0.signal: no signal 'path_error.crosstrack' is recorded, did you mean "
        "path_error.cross_track?",
    ]
    assert sorted(path.name for path in (folder / "out").iterdir()) == ["short_flight", "thrown", "too_strict"]
    assert (folder / "out" / "too_strict" / "run.mcap").is_file()


@pytest.mark.flight
def test_json_names_the_scenario_of_each_result(scenarios, monkeypatch, capsys):
    scenarios(a=FLIGHT, d=WRONG)
    arguments = ("--record", "none", "--json")
    code, stdout, _ = call(monkeypatch, capsys, "run", "missions/a.yaml", "missions/d.yaml", *arguments)
    first, second = json.loads(stdout)
    assert code == 2
    assert (first["scenario"], first["verdict"]) == ("missions/a.yaml", "PASS")
    assert first["checks"][0]["value"] is not None
    assert (second["scenario"], second["verdict"]) == ("missions/d.yaml", "INVALID")
    assert second["mistakes"] == ["missions/d.yaml:4:1: durtion_s: unknown key; did you mean duration_s?"]
    # A file alone is told as it always was; a folder is told as a list, whatever it holds.
    alone = json.loads(call(monkeypatch, capsys, "run", "missions/a.yaml", *arguments)[1])
    assert alone.keys() == first.keys() - {"scenario"}
    (scenarios() / "missions" / "d.yaml").unlink()
    assert [each["scenario"] for each in json.loads(call(monkeypatch, capsys, "run", "missions", *arguments)[1])] == [
        "missions/a.yaml"
    ]


@pytest.mark.flight
def test_what_own_code_prints_does_not_get_among_the_json(scenarios, monkeypatch, capsys):
    law = "    print('hello')\n    return lambda aim: [0.0] * 6\n"
    folder = scenarios(a=FLIGHT.replace("checks:", "control: {law: {python: 'law.py:law'}}\nchecks:"))
    (folder / "missions" / "law.py").write_text(f"def law(setup):\n{law}")
    for arguments in (("missions/a.yaml",), ("missions",)):
        _, stdout, stderr = call(monkeypatch, capsys, "run", *arguments, "--record", "none", "--json")
        assert json.loads(stdout)
        assert "hello" in stderr
    _, stdout, _ = call(monkeypatch, capsys, "run", "missions/a.yaml", "--record", "none")
    assert stdout.startswith("hello")


@pytest.mark.flight
@pytest.mark.parametrize(
    ("texts", "code"),
    [
        ({"a": FLIGHT, "b": FLIGHT}, 0),
        ({"a": FLIGHT, "b": UNJUDGED}, 3),
        ({"a": UNJUDGED, "b": WRONG}, 2),
        ({"a": FAILING, "b": WRONG, "c": UNJUDGED}, 1),
    ],
)
def test_the_exit_code_is_that_of_the_worst(scenarios, monkeypatch, capsys, texts, code):
    scenarios(**texts)
    assert call(monkeypatch, capsys, "run", "missions", "--record", "none", "--quiet")[0] == code


@pytest.mark.flight
def test_two_of_one_name_have_a_folder_each(scenarios, monkeypatch, capsys):
    folder = scenarios(a=FLIGHT, b=FLIGHT)
    assert call(monkeypatch, capsys, "run", "missions", "--out", "out", "--record", "none")[0] == 0
    assert sorted(path.name for path in (folder / "out").iterdir()) == ["short_flight", "short_flight-2"]
    # Again into the same folders, as with one run.
    assert call(monkeypatch, capsys, "run", "missions", "--out", "out", "--record", "none")[0] == 0
    assert len(list((folder / "out").iterdir())) == 2
    code, _, stderr = call(monkeypatch, capsys, "run", "missions", "--out", "out/short_flight", "--record", "none")
    assert (code, stderr.count("\n")) == (2, 1)
    assert stderr.startswith("out/short_flight: is the folder of a run; give a new one")


def test_nothing_is_flown_where_nothing_can_be(scenarios, monkeypatch, capsys):
    folder = scenarios(d=WRONG)
    code, stdout, _ = call(monkeypatch, capsys, "run", "missions", "--out", "out")
    assert (code, stdout.splitlines()[0]) == (2, "INVALID  1 INVALID of 1 scenarios")
    assert not (folder / "out").exists()
    (folder / "missions" / "d.yaml").unlink()
    code, stdout, stderr = call(monkeypatch, capsys, "run", "missions")
    assert (code, stdout) == (2, "")
    assert stderr == "missions: holds no scenario: there is no YAML file in it\n"
    for option in (("--sample", "1"), ("--live",)):
        code, _, stderr = call(monkeypatch, capsys, "run", "a.yaml", "b.yaml", *option)
        assert (code, stderr) == (2, f"{option[0]} is of one scenario; 2 files or folders were given\n")


@pytest.mark.flight
def test_an_interrupt_tells_what_was_flown(scenarios):
    folder = scenarios(a=FLIGHT, b=FLIGHT.replace("duration_s: 0.5", "duration_s: 80000"), c=FLIGHT)
    with started("run", "missions", "--record", "mcap", "--out", "out", cwd=folder) as process:
        record = folder / "out" / "short_flight-2" / "run.mcap"
        while not record.is_file() or record.stat().st_size < 300_000:
            assert process.poll() is None
        process.send_signal(signal.SIGTERM)
        stdout, stderr = process.communicate(timeout=120)
    assert process.returncode == 128 + signal.SIGTERM
    assert "interrupted by SIGTERM; recorded so far: out/short_flight-2" in stderr
    rows = [line.split() for line in stdout.splitlines() if line.startswith("missions/")]
    assert [row[:3] for row in rows][1:] == [["missions/b.yaml", "not", "flown"], ["missions/c.yaml", "not", "flown"]]
    assert rows[0][:2] == ["missions/a.yaml", "PASS"]


def test_validate_says_what_a_flight_would_refuse_and_flies_nothing(scenarios, monkeypatch, capsys):
    event = "events: [{kind: thrusters, at_s: 0.1, thrusters: [T99], state: dead}]"
    folder = scenarios(a=FLIGHT, d=WRONG, e=MISNAMED, f=FLIGHT.replace("checks:", f"{event}\nchecks:"))
    code, stdout, stderr = call(monkeypatch, capsys, "validate", "missions")
    assert (code, stdout) == (2, "1 of 4 can be flown\n")
    assert [line.split(": ")[0] for line in stderr.splitlines()] == [
        "missions/d.yaml:4:1",
        "missions/e.yaml:9:28",
        "missions/f.yaml:8:51",
    ]
    assert call(monkeypatch, capsys, "validate", "missions/a.yaml", "--quiet") == (0, "", "")
    code, stdout, stderr = call(monkeypatch, capsys, "validate", "missions", "--json")
    assert (code, stderr) == (2, "")
    assert [(each["scenario"], each["valid"], len(each["mistakes"])) for each in json.loads(stdout)] == [
        ("missions/a.yaml", True, 0),
        ("missions/d.yaml", False, 1),
        ("missions/e.yaml", False, 1),
        ("missions/f.yaml", False, 1),
    ]
    code, _, stderr = call(monkeypatch, capsys, "validate", "missions/a.yaml", "--set", "duration_s=-1")
    assert (code, stderr) == (2, "override duration_s: must be greater than 0, got -1\n")
    assert {path.name for path in folder.iterdir()} == {"missions"}
