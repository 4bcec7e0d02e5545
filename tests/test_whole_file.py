"""A result is whole or not there, and what was there before stays until it is."""

from __future__ import annotations

from contextlib import suppress

import pytest

from cube_sim.whole_file import filled_whole, undo_unfinished, written_whole


def test_a_file_is_replaced_once_it_is_whole(tmp_path):
    file = tmp_path / "page.html"
    file.write_text("earlier")
    with written_whole(file) as part:
        part.write_text("half")
        assert (file.read_text(), part.suffix) == ("earlier", ".html")
        part.write_text("whole")
    assert file.read_text() == "whole"
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("error", [OSError("full"), KeyboardInterrupt()])
def test_what_fails_leaves_the_earlier_file_and_nothing_else(tmp_path, error):
    file = tmp_path / "page.html"
    file.write_text("earlier")

    def fail():
        with written_whole(file) as part:
            part.write_text("half")
            raise error

    with pytest.raises(type(error)):
        fail()
    assert file.read_text() == "earlier"
    assert list(tmp_path.iterdir()) == [file]


def test_a_folder_that_is_missing_is_named(tmp_path):
    with pytest.raises(FileNotFoundError) as raised, written_whole(tmp_path / "no" / "page.html"):
        pass
    assert raised.value.strerror == f"there is no folder {tmp_path / 'no'}"


def test_a_process_that_ends_at_once_leaves_nothing_half_written(tmp_path):
    file, folder = tmp_path / "page.html", tmp_path / "tables"
    file.write_text("earlier")
    with suppress(FileNotFoundError), written_whole(file) as part, filled_whole(folder):
        part.write_text("half")
        (folder / "a.csv").write_text("half")
        undo_unfinished()
        assert list(tmp_path.iterdir()) == [file]
        assert file.read_text() == "earlier"


def test_a_link_stays_one_and_a_device_is_written_as_it_is(tmp_path):
    file, link = tmp_path / "a.txt", tmp_path / "b.txt"
    file.write_text("")
    link.symlink_to(file)
    with written_whole(link) as part:
        part.write_text("new")
    assert link.is_symlink()
    assert file.read_text() == "new"
    with written_whole(type(file)("/dev/null")) as part:
        assert str(part) == "/dev/null"


@pytest.mark.parametrize("there", [False, True])
def test_a_folder_that_cannot_be_filled_is_as_it_was(tmp_path, there):
    folder = tmp_path / "out"
    if there:
        folder.mkdir()

    def fail():
        with filled_whole(folder):
            (folder / "sub").mkdir()
            (folder / "sub" / "a").write_text("a")
            (folder / "b").write_text("b")
            raise OSError("full")

    with pytest.raises(OSError, match="full"):
        fail()
    assert folder.exists() == there
    assert [*tmp_path.rglob("*")] == ([folder] if there else [])
