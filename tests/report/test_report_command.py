"""`cube-sim report` as people call it: what it writes, where, and what it refuses in one line."""

from __future__ import annotations

import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET

import pytest
from support.command_line import call
from support.own_code import scenario_with

import cube_sim


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flown")
    return cube_sim.run(scenario_with(folder, ""), {"duration_s": 3.0}, folder / "run").directory


def test_what_is_no_run_is_one_line(tmp_path, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "report", tmp_path / "none")
    assert (code, out, err) == (2, "", f"{tmp_path / 'none'}: no such file\n")
    code, out, err = call(monkeypatch, capsys, "report", tmp_path)
    assert (code, out, err) == (2, "", f"{tmp_path}: is not the folder of a run: there is no run.mcap in it\n")
    (tmp_path / "run.mcap").write_bytes(b"nothing of ours")
    code, out, err = call(monkeypatch, capsys, "report", tmp_path)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert [file.name for file in tmp_path.iterdir()] == ["run.mcap"]


@pytest.mark.flight
def test_a_page_is_written_beside_the_run(flown, monkeypatch, capsys):
    code, out, _ = call(monkeypatch, capsys, "report", flown)
    page = flown.with_name("run.html")
    assert (code, out) == (0, f"{page}\n")
    said = page.read_text(encoding="utf-8")
    ET.fromstring(said.partition("\n")[2])
    assert "PASS" in said
    assert str(flown) not in said
    # The run's folder is as it was: another run may still write there.
    assert sorted(file.name for file in flown.iterdir()) == ["resolved.yaml", "run.mcap", "run.rrd", "verdict.json"]
    page.unlink()
    assert call(monkeypatch, capsys, "report", flown / "run.mcap")[:2] == (0, f"{page}\n")
    code, _, _ = call(monkeypatch, capsys, "report", flown, "--out", flown.with_name("again.html"))
    assert (code, flown.with_name("again.html").read_bytes()) == (0, page.read_bytes())


@pytest.mark.flight
def test_a_record_alone_says_its_verdict_and_one_cut_short_never_passes(flown, tmp_path, monkeypatch, capsys):
    shutil.copy(flown / "run.mcap", tmp_path / "alone.mcap")
    assert call(monkeypatch, capsys, "report", tmp_path / "alone.mcap")[0] == 0
    assert "<title>short_flight: PASS</title>" in (tmp_path / "alone.html").read_text(encoding="utf-8")
    cut = tmp_path / "cut"
    shutil.copytree(flown, cut)
    whole = (cut / "run.mcap").read_bytes()
    (cut / "run.mcap").write_bytes(whole[: len(whole) * 6 // 10])
    assert call(monkeypatch, capsys, "report", cut, flown)[0] == 0
    said = (tmp_path / "cut_and_1_more.html").read_text(encoding="utf-8")
    assert "<title>short_flight: ERROR, PASS</title>" in said


@pytest.mark.flight
def test_what_cannot_be_written_is_one_line(flown, tmp_path, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "report", flown, "--out", tmp_path)
    assert (code, out, err) == (2, "", f"{tmp_path}: is a folder; give the name of a file\n")
    record = flown / "run.mcap"
    before = record.read_bytes()
    code, out, err = call(monkeypatch, capsys, "report", flown, "--out", record)
    assert (code, out, err) == (2, "", f"{record}: a report is a page of HTML, run.html for example\n")
    assert record.read_bytes() == before
    code, out, err = call(monkeypatch, capsys, "report", flown, "--out", tmp_path / "no" / "page.html")
    assert (code, out) == (3, "")
    assert err == f"{tmp_path / 'no' / 'page.html'}: cannot be written: there is no folder {tmp_path / 'no'}\n"


@pytest.mark.flight
def test_a_report_loads_nothing_that_flies_or_draws(flown, tmp_path):
    program = (
        "import sys\nfrom cube_sim.commands.cli import main\n"
        f"sys.argv = ['cube-sim', 'report', {str(flown)!r}, '--out', 'page.html']\n"
        "try:\n    main()\nfinally:\n"
        "    heavy = ('mujoco', 'numba', 'rerun', 'matplotlib', 'scipy', 'proxsuite')\n"
        "    print(*[name for name in heavy if name in sys.modules], file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr.split()) == (0, [])
