"""`cube-sim view` as people call it: one run, two on one time, a browser, and no screen at all."""

from __future__ import annotations

import signal
import time
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader
from support.command_line import call, started
from support.edited_cube import edited_text
from support.helix_run import END, HEADER, fly, model, table
from support.own_code import scenario_with
from support.places import CUBE
from support.scenario_files import FLIGHT

import cube_sim
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.rerun.viewer import has_display, web_viewer


@pytest.fixture
def recorded(tmp_path):
    folder = tmp_path / "recorded"
    folder.mkdir()
    with Recorder(folder, HEADER, table(), model(), view=False) as recorder:
        fly(recorder, 60)
        recorder.finish(END)
    return folder


@pytest.fixture
def no_screen(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")


def test_without_a_screen_one_line_says_what_else_there_is(recorded, no_screen, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "view", recorded)
    assert (code, out, err.count("\n")) == (3, "", 1)
    assert "no screen" in err
    assert "--web" in err
    assert has_display({"WAYLAND_DISPLAY": "wayland-0"})


def test_what_is_no_run_is_one_line(tmp_path, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "view", tmp_path / "none", "--save", tmp_path / "a.rrd")
    assert (code, out, err) == (2, "", f"{tmp_path / 'none'}: no such file\n")
    code, out, err = call(monkeypatch, capsys, "view", *[tmp_path] * 7, "--save", tmp_path / "a.rrd")
    assert (code, out, err) == (2, "", "7 runs; a view shows up to 6\n")
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_run_is_told_before_that_there_is_no_screen(tmp_path, no_screen, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "view", tmp_path / "none")
    assert (code, out, err) == (2, "", f"{tmp_path / 'none'}: no such file\n")
    code, out, err = call(monkeypatch, capsys, "view", *[tmp_path] * 7)
    assert (code, out, err) == (2, "", "7 runs; a view shows up to 6\n")


def test_a_view_that_cannot_be_written_is_one_line(recorded, tmp_path, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "view", recorded, "--save", tmp_path / "no" / "a.rrd")
    assert (code, out, err.count("\n")) == (3, "", 1)
    code, out, err = call(monkeypatch, capsys, "view", recorded, "--save", tmp_path)
    assert (code, out, err) == (2, "", f"{tmp_path}: is a folder; give the name of a file\n")


def test_the_view_is_made_of_the_record(recorded, tmp_path, monkeypatch, capsys):
    file = tmp_path / "a.rrd"
    assert call(monkeypatch, capsys, "view", recorded / "run.mcap", "--save", file) == (0, f"{file}\n", "")
    assert len(RrdReader(file).recordings()) == 1


def test_a_browser_is_served_the_viewer(recorded, tmp_path, monkeypatch, capsys):
    call(monkeypatch, capsys, "view", recorded, "--save", tmp_path / "a.rrd")
    with web_viewer(tmp_path / "a.rrd") as viewer:
        deadline = time.monotonic() + 30
        while True:
            try:
                with urllib.request.urlopen(viewer.url, timeout=5) as page:
                    assert b"rerun" in page.read().lower()
                break
            except urllib.error.URLError:
                assert time.monotonic() < deadline
                time.sleep(0.2)
    assert viewer.process.poll() is not None


@pytest.mark.flight
def test_whoever_ends_the_command_ends_the_viewer(recorded):
    with started("view", recorded, "--web", cwd=recorded.parent) as process:
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        assert process.stdout.readline() == "Ctrl-C ends it\n"
        (viewer,) = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=60) == 143
        assert not Path(f"/proc/{viewer}").exists()


def test_a_view_is_saved_as_what_it_is(tmp_path, monkeypatch, capsys):
    said = f"{tmp_path / 'foo.txt'}: a view is a file of Rerun, foo.rrd for example\n"
    assert call(monkeypatch, capsys, "view", tmp_path, "--save", tmp_path / "foo.txt") == (2, "", said)


@pytest.mark.flight
def test_two_runs_are_one_recording_below_two_prefixes(tmp_path, monkeypatch, capsys):
    scenario = scenario_with(tmp_path, "")
    runs = [
        cube_sim.run(scenario, {"duration_s": 2.0, "guidance.speed_m_s": speed}, tmp_path / name, record="mcap")
        for name, speed in (("slow", 0.2), ("fast", 0.4))
    ]
    file = tmp_path / "two.rrd"
    code, _, err = call(monkeypatch, capsys, "view", *(run.directory for run in runs), "--save", file)
    assert (code, err) == (0, "")
    reader = RrdReader(file)
    assert (len(reader.recordings()), len(reader.blueprints())) == (1, 1)
    chunks = list(reader.stream())
    for prefix, name, run in zip(("/a", "/b"), ("slow", "fast"), runs, strict=True):
        (curve,) = [
            chunk.to_record_batch().column("Scalars:scalars").to_pylist()
            for chunk in chunks
            if chunk.entity_path == f"{prefix}/plot/path_error/cross_track" and not chunk.is_static
        ]
        assert np.array_equal(curve, run.signals["path_error.cross_track"][:, 1:])
        (label,) = [
            chunk.to_record_batch().column("SeriesLines:names").to_pylist()[0]
            for chunk in chunks
            if chunk.entity_path == f"{prefix}/plot/path_error/cross_track" and chunk.is_static
        ]
        assert label == [f"{name}: cross-track [m]"]
    assert {str(chunk.entity_path).split("/")[1] for chunk in chunks} <= {"a", "b", "__properties"}


@pytest.mark.flight
def test_a_vehicle_with_a_thruster_in_a_pod_is_shown(tmp_path, monkeypatch, capsys):
    start = '<site name="T8"'
    site = start + CUBE.read_text().partition(start)[2].partition("/>")[0] + "/>"
    (tmp_path / "pod.xml").write_text(edited_text((site, f'<body name="pod" pos="0 0 0.1">{site}</body>')))
    path = tmp_path / "pod.yaml"
    path.write_text(FLIGHT.replace(str(CUBE), "pod.xml"))
    run = cube_sim.run(path, out=tmp_path / "run")
    assert not any("rrd" in line.text or "/scene" in line.text for line in run.log)
    assert call(monkeypatch, capsys, "view", run.directory, "--save", tmp_path / "a.rrd")[0] == 0
    assert call(monkeypatch, capsys, "export", run.directory, tmp_path / "made", "--format", "rrd")[0] == 0
    for rrd in (run.directory / "run.rrd", tmp_path / "a.rrd", tmp_path / "made" / "run.rrd"):
        drawn = {chunk.entity_path for chunk in RrdReader(rrd).stream() if not chunk.is_static}
        assert "/world/vehicle/thrust" in drawn
