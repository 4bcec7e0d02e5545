"""Where a run may write: a new folder, an empty one, an earlier run's; nothing else is touched."""

from __future__ import annotations

import os
import re

import pytest

from cube_sim.errors import RecordingError
from cube_sim.run_directory import FILES, check, default_directory, prepare


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("kept", [(), FILES[:1], FILES[2:], FILES])
def test_an_earlier_run_is_replaced_but_not_by_a_check(tmp_path, kept):
    for name in kept:
        (tmp_path / name).write_text("earlier")
    before = contents(tmp_path)
    check(tmp_path)
    assert contents(tmp_path) == before
    prepare(tmp_path)
    assert contents(tmp_path) == {}


def test_a_new_folder_is_made_with_its_parents_but_not_by_a_check(tmp_path):
    folder = tmp_path / "a" / "b"
    check(folder)
    assert not folder.parent.exists()
    prepare(folder)
    assert folder.is_dir()


@pytest.mark.parametrize("name", ["notes.txt", ".hidden", "run.mcap.bak", "RUN.MCAP"])
def test_anything_else_is_refused_and_kept(tmp_path, name):
    (tmp_path / "run.mcap").write_text("earlier")
    (tmp_path / name).write_text("mine")
    before = contents(tmp_path)
    for attempt in (check, prepare):
        with pytest.raises(RecordingError, match=re.escape(f"{tmp_path}: holds {name}, which no run wrote")):
            attempt(tmp_path)
    assert contents(tmp_path) == before


def test_a_folder_by_the_name_of_a_recording_is_refused(tmp_path):
    (tmp_path / "run.rrd").mkdir()
    with pytest.raises(RecordingError, match=r"run\.rrd is a folder"):
        prepare(tmp_path)


def test_files_in_the_way_are_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("mine")
    with pytest.raises(RecordingError, match="Not a directory"):
        check(file)
    with pytest.raises(RecordingError, match="Not a directory"):
        check(file / "below")
    assert file.read_text() == "mine"


def test_a_folder_without_write_permission_is_refused(tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir()
    closed.chmod(0o500)
    if os.access(closed, os.W_OK):
        pytest.skip("this user may write everywhere")
    for folder in (closed, closed / "below"):
        with pytest.raises(RecordingError, match="no permission to write"):
            check(folder)


def test_default_folders_differ_and_name_the_scenario(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    seen = set()
    for _ in range(4):
        folder = default_directory("dive")
        assert re.fullmatch(r"logs/dive-\d{8}T\d{6}Z(-\d+)?", str(folder))
        assert not folder.exists()
        prepare(folder)
        seen.add(folder)
    assert len(seen) == 4
