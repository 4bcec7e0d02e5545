"""The folder of a sweep: what was told stored is there, whatever happens."""

from __future__ import annotations

import json

import pytest

from cube_sim.campaign import folder as folders
from cube_sim.campaign.folder import WHOLE, Shard, SweepFolder, opened, rows_in
from cube_sim.campaign.rows import joined
from cube_sim.campaign.sample_flight import FlownSample
from cube_sim.errors import DirectoryError

IDENTITY = {"scenario": "a", "files": {"model/cube.xml": "b"}, "versions": {"numpy": "2"}}
HEAD = {"format": 1, "identity": IDENTITY}


def flown(k):
    return FlownSample({"sample": k, "verdict": "PASS", "reason": "", "seed": k}, 0.1, 0.2)


def numbers(folder):
    return rows_in(folder)["sample"].to_pylist()


def test_what_is_stored_is_found_by_whoever_comes_after_a_kill(tmp_path, monkeypatch):
    monkeypatch.setattr(folders, "EVERY_S", 0.0)
    store = SweepFolder(tmp_path, WHOLE, [], joined([]))
    for k in (4, 0, 7):
        store.append(flown(k))
        assert store.stored == len(numbers(tmp_path))
    (tmp_path / "parts" / ".half.part.parquet").write_bytes(b"PAR1")  # what a kill amid a write leaves
    after = SweepFolder(tmp_path, WHOLE, [], rows_in(tmp_path))
    assert after.done == {0, 4, 7}
    after.append(flown(1))
    after.finish()
    assert numbers(tmp_path) == [0, 1, 4, 7]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["parts", "rows.parquet", "times.parquet"]


def test_rows_wait_a_second_and_are_not_told_stored_before(tmp_path, monkeypatch):
    monkeypatch.setattr(folders, "EVERY_S", 1e9)
    store = SweepFolder(tmp_path, WHOLE, [], joined([]))
    store.append(flown(0))
    assert (store.stored, numbers(tmp_path)) == (0, [])
    store.flush()
    assert (store.stored, numbers(tmp_path)) == (1, [0])


def test_many_parts_become_few(tmp_path, monkeypatch):
    monkeypatch.setattr(folders, "EVERY_S", 0.0)
    monkeypatch.setattr(folders, "MANY", 3)
    store = SweepFolder(tmp_path, WHOLE, [], joined([]))
    for k in range(50):
        store.append(flown(k))
        assert len([*(tmp_path / "parts").iterdir()]) <= 2 * 4  # two of a level at most, levels of 1, 3, 9, 27
    assert numbers(tmp_path) == list(range(50))
    store.finish()
    assert numbers(tmp_path) == list(range(50))


def test_parts_of_a_sweep_share_a_folder(tmp_path):
    for shard in (Shard(2, 3), Shard(1, 3)):
        with opened(tmp_path, shard, HEAD, resume=False, checks=[]) as store:
            assert store.done.isdisjoint(shard.samples(8))
            for k in shard.samples(8):
                store.append(flown(k))
            assert store.finish()["sample"].to_pylist() == list(shard.samples(8))
    assert {file.name for file in tmp_path.glob("*.parquet")} == {
        f"{name}-{number}-of-3.parquet" for name in ("rows", "times") for number in (1, 2)
    }
    with opened(tmp_path, WHOLE, HEAD, resume=True, checks=[]) as store:
        assert [k for k in range(8) if k not in store.done] == [2, 5]
        store.append(flown(2))
        store.append(flown(5))
        store.finish()
    assert {file.name for file in tmp_path.glob("*.parquet")} == {"rows.parquet", "times.parquet"}
    assert numbers(tmp_path) == list(range(8))
    assert rows_in(tmp_path)["wall_s"].to_pylist() == [0.2] * 8


def refused(folder, head=HEAD, *, resume=False, shard=WHOLE):
    with pytest.raises(DirectoryError) as caught, opened(folder, shard, head, resume=resume, checks=[]):
        pass
    return str(caught.value).replace(str(folder), "OUT")


def test_a_folder_of_something_else_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("")
    assert refused(tmp_path) == "OUT: holds thesis.tex, not from a sweep: give a new folder"
    assert [file.name for file in tmp_path.iterdir()] == ["thesis.tex"]


def test_an_earlier_sweep_is_gone_on_with_only_when_asked(tmp_path):
    with opened(tmp_path, WHOLE, HEAD, resume=False, checks=[]) as store:
        store.append(flown(0))
        store.flush()
    assert refused(tmp_path) == "OUT: holds rows of this sweep: go on with --resume, or give a new folder"
    with opened(tmp_path, WHOLE, HEAD, resume=True, checks=[]) as store:
        assert store.done == {0}
        store.finish()
    assert refused(tmp_path) == "OUT: holds rows of this sweep: go on with --resume, or give a new folder"


def test_another_sweep_is_not_gone_on_with(tmp_path):
    with opened(tmp_path, WHOLE, HEAD, resume=False, checks=[]):
        pass
    before = (tmp_path / "sweep.json").read_text()
    other = {"scenario": "c", "files": {"model/cube.xml": "d"}, "versions": {"numpy": "3"}}
    said = "OUT: holds another sweep; what differs: scenario; file model/cube.xml; version of numpy; give a new folder"
    assert refused(tmp_path, {**HEAD, "identity": other}, resume=True) == said
    assert (tmp_path / "sweep.json").read_text() == before
    (tmp_path / "sweep.json").write_text(json.dumps({"format": 7}))
    assert refused(tmp_path, resume=True) == "OUT: sweep.json is of another version of cube_sim"


def test_two_do_not_write_at_once(tmp_path):
    with opened(tmp_path, WHOLE, HEAD, resume=False, checks=[]):
        for shard in (WHOLE, Shard(1, 2)):
            assert refused(tmp_path, resume=True, shard=shard) == "OUT: another sweep is writing there"
    with opened(tmp_path, Shard(1, 2), HEAD, resume=False, checks=[]):
        with opened(tmp_path, Shard(2, 2), HEAD, resume=False, checks=[]):
            pass
        for shard in (WHOLE, Shard(1, 2)):  # who has all of the folder would remove what a part is writing
            assert refused(tmp_path, resume=True, shard=shard) == "OUT: another sweep is writing there"


def test_no_lock_is_left_and_none_is_taken_away_from_those_who_wait(tmp_path):
    with opened(tmp_path, Shard(1, 2), HEAD, resume=False, checks=[]):
        lock = (tmp_path / ".lock-1-of-2").stat().st_ino
    with opened(tmp_path, Shard(1, 2), HEAD, resume=True, checks=[]):
        assert (tmp_path / ".lock-1-of-2").stat().st_ino == lock
    with opened(tmp_path, WHOLE, HEAD, resume=True, checks=[]) as store:
        store.finish()
    assert {file.name for file in tmp_path.iterdir()} == {"sweep.json", "rows.parquet", "times.parquet"}


def test_a_damaged_file_is_named(tmp_path):
    with opened(tmp_path, WHOLE, HEAD, resume=False, checks=[]):
        pass
    (tmp_path / "rows.parquet").write_bytes(b"PAR1, but no more of it")
    assert refused(tmp_path, resume=True).startswith("OUT/rows.parquet: cannot be read: ")
