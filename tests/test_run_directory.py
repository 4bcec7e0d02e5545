"""Where a run may write: a new folder, an empty one, an earlier run's; nothing else is touched."""

from __future__ import annotations

import contextlib
import errno
import multiprocessing
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cube_sim.errors import DirectoryError
from cube_sim.run_directory import (
    FILES,
    MCAP_FILE,
    PARTS,
    VERDICT_BYTES,
    VERDICT_FILE,
    claim,
    nothing_recorded,
    require_writable,
    reserve_verdict,
    write_verdict,
)


def prepare(folder):
    with claim(folder, "dive") as place:
        assert place.directory == folder
        place.begin()


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("kept", [(), FILES[:1], FILES[2:], FILES])
def test_an_earlier_run_is_replaced_but_not_by_a_check(tmp_path, kept):
    for name in kept:
        (tmp_path / name).write_text("earlier")
    before = contents(tmp_path)
    require_writable(tmp_path)
    assert contents(tmp_path) == before
    prepare(tmp_path)
    assert contents(tmp_path) == {}


def test_an_earlier_run_stays_whole_until_the_new_one_begins(tmp_path):
    for name in FILES:
        (tmp_path / name).write_text("earlier")
    before = contents(tmp_path)

    def fail():
        with claim(tmp_path, "dive") as place:
            assert contents(tmp_path) == before
            (tmp_path / PARTS[0]).write_text("begun")
            raise ZeroDivisionError(place)

    with pytest.raises(ZeroDivisionError):
        fail()
    assert contents(tmp_path) == before
    with claim(tmp_path, "dive") as place:
        assert nothing_recorded()
        place.begin()
        (tmp_path / FILES[0]).write_text("new")
        place.begin()
        assert not nothing_recorded()
    assert contents(tmp_path) == {Path(FILES[0]): b"new"}
    assert not nothing_recorded()


def test_what_is_replaced_in_one_move_stays_until_then(tmp_path):
    for name in FILES:
        (tmp_path / name).write_text("earlier")
    with claim(tmp_path, "dive") as place:
        place.begin(but=(MCAP_FILE,))
    assert contents(tmp_path) == {Path(MCAP_FILE): b"earlier"}


def test_a_folder_made_for_a_run_that_never_began_goes_with_it(tmp_path):
    for begins in (False, True):
        with contextlib.suppress(ZeroDivisionError), claim(tmp_path / "out", "dive") as place:
            if begins:
                place.begin()
            raise ZeroDivisionError
        assert (tmp_path / "out").exists() == begins


def test_a_new_folder_is_made_with_its_parents_but_not_by_a_check(tmp_path):
    folder = tmp_path / "a" / "b"
    require_writable(folder)
    assert not folder.parent.exists()
    prepare(folder)
    assert folder.is_dir()


@pytest.mark.parametrize("name", ["notes.txt", ".hidden", "run.mcap.bak", "RUN.MCAP"])
def test_anything_else_is_refused_and_kept(tmp_path, name):
    (tmp_path / "run.mcap").write_text("earlier")
    (tmp_path / name).write_text("mine")
    before = contents(tmp_path)
    for attempt in (require_writable, prepare):
        with pytest.raises(DirectoryError, match=re.escape(f"{tmp_path}: holds {name}, not from a run")):
            attempt(tmp_path)
    assert contents(tmp_path) == before


def test_a_verdict_goes_where_room_was_reserved(tmp_path):
    with claim(tmp_path, "dive") as place:
        reserve_verdict(tmp_path)
        place.begin()
        reserved = (tmp_path / PARTS[FILES.index(VERDICT_FILE)]).stat()
        assert 512 * reserved.st_blocks >= VERDICT_BYTES
        for text in ("{}\n", "ü" * VERDICT_BYTES):  # shorter than the room, and longer
            write_verdict(tmp_path, text)
            assert (tmp_path / VERDICT_FILE).read_text("utf-8") == text
            assert ((tmp_path / VERDICT_FILE).stat().st_ino == reserved.st_ino) == (text == "{}\n")
    assert contents(tmp_path).keys() == {Path(VERDICT_FILE)}


def test_a_folder_by_the_name_of_a_recording_is_refused(tmp_path):
    (tmp_path / "run.rrd").mkdir()
    with pytest.raises(DirectoryError, match=r"run\.rrd is a folder"):
        prepare(tmp_path)


def test_files_in_the_way_are_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("mine")
    with pytest.raises(DirectoryError, match="Not a directory"):
        require_writable(file)
    with pytest.raises(DirectoryError, match="Not a directory"):
        require_writable(file / "below")
    assert file.read_text() == "mine"


def test_a_folder_without_write_permission_is_refused(tmp_path, monkeypatch):
    closed = tmp_path / "closed"
    closed.mkdir()
    closed.chmod(0o500)
    if os.access(closed, os.W_OK):  # root may write everywhere
        monkeypatch.setattr(os, "access", lambda path, mode: not mode & os.W_OK or Path(path) != closed)
    for folder in (closed, closed / "below"):
        with pytest.raises(DirectoryError, match="no permission to write"):
            require_writable(folder)


def test_default_folders_differ_and_name_the_scenario(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with contextlib.ExitStack() as runs:
        folders = [runs.enter_context(claim(None, "dive")).directory for _ in range(4)]
        assert len(set(folders)) == 4
        for folder in folders:
            assert re.fullmatch(r"logs/dive-\d{8}T\d{6}Z(-\d+)?", str(folder))
            assert folder.is_dir()


def test_processes_that_start_together_share_no_folder(tmp_path):
    """Twenty claims by four processes that wait for one another: as many folders."""
    with multiprocessing.get_context("spawn").Pool(4, os.chdir, (tmp_path,)) as pool:
        names = pool.map(_claimed, range(20), chunksize=5)
    assert len(set(names)) == 20
    assert sorted(names) == sorted(f"logs/{path.name}" for path in (tmp_path / "logs").iterdir())


def _claimed(_):
    with claim(None, "dive") as place:
        place.begin()
        return str(place.directory)


def test_a_folder_in_use_is_refused_and_kept_until_the_run_ends(tmp_path):
    folder = tmp_path / "out"
    with claim(folder, "dive"):
        (folder / "run.mcap").write_text("being written")
        for _ in range(2):
            with pytest.raises(DirectoryError, match="another run is writing there"):
                prepare(folder)
        assert contents(folder) == {Path("run.mcap"): b"being written"}
    prepare(folder)
    assert contents(folder) == {}


def test_a_killed_run_leaves_no_claim(tmp_path):
    folder = tmp_path / "out"
    program = (
        "import sys, time, pathlib\nfrom cube_sim.run_directory import claim\n"
        "with claim(pathlib.Path(sys.argv[1]), 'dive'):\n    print('mine', flush=True)\n    time.sleep(600)\n"
    )
    with subprocess.Popen([sys.executable, "-c", program, str(folder)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "mine\n"
        with pytest.raises(DirectoryError, match="another run is writing there"):
            prepare(folder)
        process.kill()
        process.wait(timeout=30)
    prepare(folder)


def test_links_that_lead_nowhere_and_folders_nobody_can_make_are_refused(tmp_path):
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "nowhere")
    with pytest.raises(DirectoryError, match="a link that leads nowhere"):
        require_writable(link)
    with pytest.raises(DirectoryError, match="cannot"):
        prepare(Path("/proc/cube_sim_run"))


def test_a_verdict_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    write_verdict(tmp_path, "one")
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"verdict.json": "one"}

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    for call in ("touch", "open", "replace"):
        with monkeypatch.context() as patch:
            patch.setattr(Path, call, full)
            with pytest.raises(OSError, match="No space"):
                write_verdict(tmp_path, "two")
        assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"verdict.json": "one"}
    (tmp_path / ".verdict.part.json").write_text("of a process that was killed")
    require_writable(tmp_path)
    prepare(tmp_path)
    assert not list(tmp_path.iterdir())
