"""A first scenario for a model: chosen by flying, and it passes."""

from __future__ import annotations

import re
import shutil

import pytest
from support.command_line import call
from support.places import CUBE, MODELS, WRITTEN_MODEL_FILES

from cube_sim import fly
from cube_sim.commands import starter
from cube_sim.scenario import load
from cube_sim.scenario.document import parse


def one_thruster(folder):
    """The CUBE with one thruster of eight, which cannot hold a point."""
    text = CUBE.read_text()
    for number in range(2, 9):
        text, count = re.subn(rf'\s*<(site|general) name="T{number}"[^>]*/>', "", text)
        assert count >= 2
    model = folder / "one.xml"
    model.write_text(text)
    return model


@pytest.mark.flight
@pytest.mark.parametrize("model", WRITTEN_MODEL_FILES, ids=lambda model: model.stem)
def test_what_is_written_for_every_model_passes(model, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "models").mkdir()
    shutil.copy(model, tmp_path / "models")
    for mesh in model.parent.glob("*.stl"):
        shutil.copy(mesh, tmp_path / "models")
    (tmp_path / "missions").mkdir()
    named = f"missions/{model.stem}.yaml"
    code, stdout, stderr = call(monkeypatch, capsys, "new", f"models/{model.name}", named)
    assert (code, stderr) == (0, "")
    assert stdout.splitlines()[1] == f"fly it:  cube-sim run {named}"
    text = (tmp_path / named).read_text()
    assert f"\nmodel: ../models/{model.name}\n" in text
    assert max(map(len, text.splitlines())) <= 120
    run = fly(named, out="out", record="none")
    assert run.verdict == "PASS"
    # It starts beside its path and has to join it: a vehicle that stays where it is does not pass.
    rms = run.checks[0]
    assert rms.value is not None
    assert rms.limit is not None
    assert rms.value <= starter._FURTHEST_M
    assert rms.value < rms.limit
    assert "T1" not in text or "thrusters: [T1]" in text


@pytest.mark.flight
def test_remarks_taken_away_are_a_scenario_that_flies(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call(monkeypatch, capsys, "new", CUBE)[0] == 0
    written = tmp_path / "cube_first.yaml"
    text = written.read_text()
    for key in ("events", "navigation"):
        assert f"# {key}: " in text
    more = re.sub(r"^# (events:|  - |navigation:)", r"\1", text, flags=re.MULTILINE)
    written.write_text(more)
    scenario = load(written).scenario
    assert len(scenario.events) == 2
    assert scenario.navigation is not None
    assert fly(written, out="out", record="none").verdict in ("PASS", "FAIL")


@pytest.mark.flight
def test_a_vehicle_that_flies_nothing_is_told_what_was_tried(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    code, stdout, stderr = call(monkeypatch, capsys, "new", one_thruster(tmp_path), "first.yaml")
    assert (code, stdout) == (2, "")
    first, *tried = stderr.splitlines()
    assert first.endswith("one.xml: flies none of the paths that were tried")
    assert [line.partition(" at ")[0] for line in tried] == [each.what for each in starter.candidates()]
    assert not (tmp_path / "first.yaml").exists()


@pytest.mark.flight
def test_a_line_that_is_only_drifted_onto_is_not_chosen(tmp_path):
    """Beside the line it is in time, but hardly moves along it: the target that waits for it is judged."""
    line = next(each for each in starter.candidates() if each.progresses)
    scenario = tmp_path / "line.yaml"
    scenario.write_text(starter.text_of(line, CUBE, None, starter._first_limits(line), tmp_path))
    assert [check.verdict for check in fly(scenario, record="none", out=tmp_path / "a").checks] == ["PASS"] * 3
    slow = fly(scenario, {"guidance.speed_m_s": 0.02}, out=tmp_path / "b", record="none")
    assert [check.verdict for check in slow.checks] == ["PASS", "FAIL", "PASS"]


def test_a_vehicle_that_needs_its_fins_is_told_at_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(starter, "starter_for", lambda *_: pytest.fail("it is flown"))
    code, stdout, stderr = call(monkeypatch, capsys, "new", CUBE.with_name("remus100.xml"))
    assert (code, stdout, stderr.count("\n")) == (2, "", 1)
    assert "remus100.xml: with its fins (stern_planes, rudder) it follows paths at none of the speeds" in stderr
    assert "0.8 to 2 m/s: 3 of 6 components are left" in stderr
    assert "a course sinking at 15 deg at 2 m/s needs more force than thrusters and fins have" in stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.flight
def test_a_vehicle_that_its_fins_steer_gets_a_line_under_way(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    code, stdout, _ = call(monkeypatch, capsys, "new", CUBE.with_name("nps_auv2.xml"), "first.yaml")
    assert code == 0
    assert "joined under way" in stdout
    text = (tmp_path / "first.yaml").read_text()
    assert "velocity_m_s: [0.8, 0, 0]   # at rest fins make nothing" in text
    assert "Follows paths in space: yes" in text
    assert fly(tmp_path / "first.yaml", out="out", record="none").verdict == "PASS"


def test_what_cannot_be_written_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.yaml").write_text("mine\n")
    for arguments, told in (
        ((CUBE, "there.yaml"), "there.yaml: is there already; give another name\n"),
        ((CUBE, "none/x.yaml"), "none/x.yaml: there is no folder none\n"),
    ):
        assert call(monkeypatch, capsys, "new", *arguments) == (2, "", told)
    assert (tmp_path / "there.yaml").read_text() == "mine\n"
    code, stdout, stderr = call(monkeypatch, capsys, "new", "none.xml")
    assert (code, stdout, stderr.count("\n")) == (2, "", 1)
    assert stderr.startswith("none.xml: ")


@pytest.mark.parametrize("text", ["models/a b.xml", "../../cube.xml", "1e3.xml", "yes", "- x", "hull: 1", "ä.xml", '"'])
def test_names_of_files_are_scalars_whatever_is_in_them(text):
    assert parse(f"model: {starter._quoted(text)}\n").data == {"model": text}


@pytest.mark.parametrize(("measured", "limit"), [(0.0, 0.05), (0.02, 0.05), (0.03, 0.06), (0.031, 0.07), (0.12, 0.3)])
def test_limits_are_twice_what_was_measured_in_one_digit(measured, limit):
    assert starter._limit(measured) == limit


@pytest.mark.flight
def test_what_is_beyond_the_critical_speed_is_the_last_choice():
    """The six-thruster BlueROV2 is stable up to 0.37 m/s; it flies a line at 0.4 m/s all the same."""
    model = MODELS / "bluerov2_vectored.xml"
    faster, slower = (
        next(each for each in starter.candidates() if (each.what, each.speed_m_s) == wanted)
        for wanted in (("a line, joined from beside it", 0.4), ("a level wave", 0.3))
    )
    assert starter.starter_for(model, None, (faster, slower)).candidate == slower
    assert starter.starter_for(model, None, (faster,)).candidate == faster
