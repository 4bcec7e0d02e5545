"""What commands leave behind where their result cannot be written: one line, and everything as it was."""

from __future__ import annotations

import resource
import shutil
import sys
from contextlib import contextmanager

import pytest
from support.command_line import call
from support.own_code import scenario_with

import cube_sim

ROOM = 5_000  # bytes, less than any of these writes at once


@contextmanager
def full_disk():
    """A file may not grow beyond `ROOM`: what a write meets on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    writes_bytecode = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # Python would leave its own files cut off, and read them again
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode = writes_bytecode


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flown")
    return cube_sim.run(scenario_with(folder, ""), {"duration_s": 2.0}, folder / "run", record="mcap").directory


@pytest.fixture
def cut_off(flown, tmp_path):
    """A record that lacks its last half second."""
    record = tmp_path / "cut" / "run.mcap"
    record.parent.mkdir()
    record.write_bytes((flown / "run.mcap").read_bytes()[:-60_000])
    return record.parent


@pytest.mark.flight
@pytest.mark.parametrize(
    ("command", "option", "target"),
    [
        (["report"], "--out", "page.html"),
        (["plot"], "--out", "figure.png"),
        (["plot"], "--out", "figure.pdf"),
        (["view"], "--save", "view.rrd"),
        (["export"], None, "tables"),
        (["export", "--format", "parquet"], None, "tables"),
        (["export", "--format", "rrd"], None, "view"),
        (["export", "--format", "inputs"], None, "inputs"),
        (["recover"], "--out", "saved"),
    ],
)
def test_nothing_half_written_stays(flown, cut_off, tmp_path, monkeypatch, capsys, command, option, target):
    place = tmp_path / target
    if place.suffix:
        place.write_text("earlier")
    name, *options = command
    run = cut_off if name == "recover" else flown
    given = [option, place] if option else [place]
    with full_disk():
        code, out, err = call(monkeypatch, capsys, name, run, *given, *options)
    assert (code, out) == (3, "")
    assert err.startswith(f"{place}: cannot be written: ")
    assert err.count("\n") == 1
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(["cut", *[target] * bool(place.suffix)])
    assert not place.suffix or place.read_text() == "earlier"


@pytest.mark.flight
def test_what_cannot_be_recovered_leaves_the_run_that_it_was_to_replace(cut_off, flown, tmp_path, monkeypatch, capsys):
    place = tmp_path / "saved"
    shutil.copytree(flown, place)
    before = {each.name: each.read_bytes() for each in place.iterdir()}
    with full_disk():
        code, out, _ = call(monkeypatch, capsys, "recover", cut_off, "--out", place)
    assert (code, out) == (3, "")
    assert {each.name: each.read_bytes() for each in place.iterdir()} == before
    assert call(monkeypatch, capsys, "recover", cut_off, "--out", place)[0] == 0
    assert sorted(each.name for each in place.iterdir()) == ["run.mcap", "run.rrd"]
