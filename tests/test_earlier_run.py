"""A run that replaces an earlier one does so when it has something to record, and not before."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest
from support.own_code import scenario_with

import cube_sim
from cube_sim.errors import CubeSimError, RecordingError, RunInterrupted
from cube_sim.flight import Loop
from cube_sim.recording.mcap import writer
from cube_sim.recording.reading import read_recording

pytestmark = pytest.mark.flight
SECOND = {"duration_s": 1.5}


@pytest.fixture
def earlier(tmp_path):
    """A scenario, the folder of its run, and what is in it."""
    scenario, out = scenario_with(tmp_path, ""), tmp_path / "run"
    cube_sim.run(scenario, SECOND, out)
    return scenario, out, contents(out)


def contents(folder):
    return {each.name: each.read_bytes() for each in folder.iterdir()}


def fails(_):
    """A law whose first answer is none."""

    def law(aim):
        raise ZeroDivisionError(aim)

    return law


@pytest.mark.parametrize("record", ["full", "none"])
def test_what_fails_before_anything_is_flown_leaves_it(earlier, record):
    scenario, out, before = earlier
    with pytest.raises(CubeSimError, match="ZeroDivisionError"):
        cube_sim.fly(scenario, SECOND, controller=fails, out=out, record=record)
    assert contents(out) == before
    with pytest.raises(CubeSimError, match="ZeroDivisionError"):
        cube_sim.fly(scenario, SECOND, controller=fails, out=out.with_name("new"), record=record)
    assert not out.with_name("new").exists()


@pytest.mark.parametrize("error", [MemoryError, KeyboardInterrupt])
@pytest.mark.parametrize("place", ["_stand", "fly_to_its_end"])
def test_whatever_ends_the_start_leaves_it(earlier, monkeypatch, error, place):
    scenario, out, before = earlier

    def ends(*_):
        raise error

    monkeypatch.setattr(Loop, place, ends)
    with pytest.raises(RunInterrupted if error is KeyboardInterrupt else error) as raised:
        cube_sim.run(scenario, SECOND, out)
    assert error is MemoryError or str(raised.value) == "interrupted"
    assert contents(out) == before


@pytest.mark.parametrize(
    ("kind", "call"), [(writer.McapWriter, "add_attachment"), (writer.McapWriter, "write_chunk"), (Path, "write_text")]
)
def test_a_disk_without_room_for_what_comes_first_leaves_it(earlier, monkeypatch, kind, call):
    scenario, out, before = earlier

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(kind, call, full)
    with pytest.raises(RecordingError, match="No space left on device"):
        cube_sim.run(scenario, SECOND, out)
    assert contents(out) == before


def test_a_record_takes_its_place_with_rows_in_it(earlier, monkeypatch):
    """A kill at any moment leaves a record that has some."""
    scenario, out, before = earlier
    seen, move_to = [], writer.McapWriter.move_to

    def watched(self, path):
        assert path.read_bytes() == before[path.name]
        seen.append(len(read_recording(self.path).signals["pose.position"]))
        move_to(self, path)

    monkeypatch.setattr(writer.McapWriter, "move_to", watched)
    cube_sim.run(scenario, SECOND, out)
    assert seen == [50]


def test_it_is_there_while_the_first_second_is_flown_and_then_replaced(earlier, monkeypatch):
    scenario, out, before = earlier
    seen, fly_on = [], Loop._fly_on

    def watched(self, *rest):
        seen.append(contents(out) == before)
        fly_on(self, *rest)

    monkeypatch.setattr(Loop, "_fly_on", watched)
    cube_sim.run(scenario, {**SECOND, "guidance.speed_m_s": 0.41}, out)
    assert seen[0]
    assert not seen[-1]
    after = contents(out)
    assert after.keys() == before.keys()
    assert all(after[name] != before[name] for name in before)
