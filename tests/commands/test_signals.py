"""``cube-sim signals``: exactly what a run of the scenario records, with the names a check may use."""

from __future__ import annotations

import json

import pytest
from support.command_line import call
from support.places import HELIX, SCENARIOS
from support.scenario_files import FLIGHT, MINIMAL, write

from cube_sim import run


def listed(monkeypatch, capsys, *arguments):
    code, stdout, stderr = call(monkeypatch, capsys, "signals", *arguments, "--json")
    assert (code, stderr) == (0, "")
    return {item.pop("signal"): item for item in json.loads(stdout)}


@pytest.mark.flight
@pytest.mark.flight
def test_they_are_those_of_a_run(tmp_path, monkeypatch, capsys):
    path = write(tmp_path, FLIGHT)
    settings = {"duration_s": 0.2, "control_period_s": 0.05, "navigation": {"heading": None, "dvl": {"rate_hz": 4}}}
    there = listed(monkeypatch, capsys, path, *(f"--set={key}={json.dumps(value)}" for key, value in settings.items()))
    signals = run(path, settings, out=tmp_path / "out").signals
    assert list(there) == list(signals)
    assert {name: item["width"] for name, item in there.items()} == {
        name: rows.shape[1] - 1 for name, rows in signals.items()
    }
    assert all(item["description"] and item["unit"] for item in there.values())
    assert (there["sensor_dvl.velocity"]["rate_hz"], there["path.points"]["rate_hz"]) == (4.0, None)
    assert there["pose.position"]["rate_hz"] == there["sensor_imu.rates"]["rate_hz"] == 20.0


def test_they_depend_on_the_scenario(monkeypatch, capsys):
    plain = listed(monkeypatch, capsys, HELIX)
    navigated = listed(monkeypatch, capsys, SCENARIOS / "cube_navigated.yaml")
    assert set(plain) < set(navigated)
    assert "navigation_error.position" in navigated
    planar = listed(monkeypatch, capsys, SCENARIOS / "infante_line.yaml")
    assert (plain["thrusters.force"]["width"], planar["thrusters.force"]["width"]) == (8, 2)
    assert plain["allocation.status"]["labels"][0] == "EXACT"
    assert plain["thrusters.force"]["columns"] == [f"T{i}" for i in range(1, 9)]


def test_the_table_names_every_signal_and_says_how_to_use_it(monkeypatch, capsys):
    code, stdout, stderr = call(monkeypatch, capsys, "signals", HELIX)
    assert (code, stderr) == (0, "")
    lines = stdout.splitlines()
    assert lines[0].split() == ["signal", "columns", "unit", "rate", "what", "it", "is"]
    names = [line.split()[0] for line in lines[1:-2] if not line.startswith(" ")]
    assert names == list(listed(monkeypatch, capsys, HELIX))
    assert "signal: path_error.cross_track" in stdout
    (lateral,) = [line for line in lines if line.startswith("path_error.lateral")]
    assert lateral.split()[1:5] == ["2", "m", "50", "Hz"]
    assert lateral.rstrip().endswith("[y1, z1]")


def test_a_check_of_no_signal_is_no_hindrance(tmp_path, monkeypatch, capsys):
    """Who asks for the names may be looking for the right one."""
    path = write(tmp_path, FLIGHT.replace("path_error.cross_track", "path_error.crosstrack"))
    assert "path_error.cross_track" in listed(monkeypatch, capsys, path)


@pytest.mark.parametrize(
    ("text", "start"),
    [
        (MINIMAL.replace("duration_s", "durtion_s"), "mission.yaml:4:1: durtion_s: unknown key; did you mean"),
        (MINIMAL, "mission.yaml:3:8: model: "),
    ],
)
def test_a_bad_scenario_is_one_line_and_bad_input(tmp_path, monkeypatch, capsys, text, start):
    write(tmp_path, text)
    monkeypatch.chdir(tmp_path)
    code, stdout, stderr = call(monkeypatch, capsys, "signals", "mission.yaml")
    assert (code, stdout, len(stderr.splitlines())) == (2, "", 1)
    assert stderr.startswith(start)
