"""A view drawn by another process is the one that would be drawn here, and what goes wrong there is told."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from importlib.util import find_spec
from pathlib import Path

import pytest
from support.helix_run import END, HEADER, fly, model, table

from cube_sim import load_run
from cube_sim.recording import beside
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.rerun import apart, patience
from cube_sim.recording.rerun.patience import Patience
from cube_sim.uninterrupted import uninterrupted

TICKS = 130


def rerun(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the viewer's own command line."""
    (folder,) = find_spec("rerun_cli").submodule_search_locations
    binary = Path(folder) / ("rerun.exe" if sys.platform == "win32" else "rerun")
    return subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, timeout=120)


@pytest.fixture
def begun(monkeypatch):
    """A process that is getting ready."""
    monkeypatch.setattr(apart, "_waiting", [])
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    apart.begin()
    (process,) = apart._waiting
    yield process
    apart._let_go()
    process.wait(60)


def await_ready(begun: subprocess.Popen[bytes]) -> None:
    assert select.select([begun.stdout], [], [], 60)[0]


def recorded(folder: Path) -> Recorder:
    folder.mkdir()
    with Recorder(folder, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)  # but not finished: Rerun puts the names of before and after into one piece or into two
    return recorder


def test_it_is_the_view_that_is_drawn_here(begun, tmp_path):
    there = recorded(tmp_path / "there")
    assert not apart._waiting
    assert begun.wait(60) == 0
    here = recorded(tmp_path / "here")
    compared = rerun("rrd", "compare", "--unordered", there.rrd, here.rrd)
    assert compared.returncode == 0, compared.stdout + compared.stderr
    assert there.warnings == here.warnings == ()


def test_one_that_is_killed_costs_the_view_alone(begun, tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)
        assert recorder._shown._made.result(60) is not None  # it draws
        begun.kill()
        recorder.finish(END)
    (warning,) = recorder.warnings
    assert warning.text.startswith("run.rrd cannot be written: the process that draws it ended with code -9; ")
    assert not recorder.rrd.exists()  # it was empty


STANDS_STILL = "run.rrd cannot be written: the process that draws it stands still; "


def stopped_amid(folder: Path, begun: subprocess.Popen[bytes]) -> Recorder:
    """A recorder whose view stands still once it draws, with more on its way to it than a pipe takes."""
    recorder = Recorder(folder, HEADER, table(), model())
    fly(recorder, TICKS)
    assert recorder._shown._made.result(60) is not None
    begun.send_signal(signal.SIGSTOP)
    fly(recorder, 20 * TICKS, first=TICKS)
    return recorder


def test_one_that_stands_still_is_given_up(begun, tmp_path, monkeypatch):
    await_ready(begun)
    monkeypatch.setattr(patience, "TAKES_S", 0.3)
    monkeypatch.setattr(beside, "MOST_WAITING", 2)  # so that the flight has to wait for it
    with stopped_amid(tmp_path, begun) as recorder:
        (warning,) = recorder.warnings  # the flight has gone on without it
        assert warning.text.startswith(STANDS_STILL)
        recorder.finish(END)
    assert begun.wait(60) == -signal.SIGKILL
    assert not recorder.rrd.exists()
    (warning,) = recorder.warnings
    assert warning.text.startswith(STANDS_STILL)
    kept = load_run(tmp_path)
    assert kept.complete
    assert kept.recorded_s > 10.0


def test_one_that_stands_still_at_the_end_is_given_up(begun, tmp_path, monkeypatch):
    monkeypatch.setattr(patience, "ENDS_S", 0.3)
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, 52)  # a pipe takes what they are
        while not recorder.rrd.exists():  # it has taken what it draws
            assert begun.poll() is None
            time.sleep(0.01)
        begun.send_signal(signal.SIGSTOP)
        recorder.finish(END)
    (warning,) = recorder.warnings
    assert warning.text.startswith(STANDS_STILL)
    assert begun.wait(60) == -signal.SIGKILL


@pytest.fixture
def interruptible():
    """Ctrl-C counts, though a shell starts what it puts into the background without it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def finish_once_asked_to_end(recorder: Recorder, held_back: bool) -> None:
    with uninterrupted():
        if held_back:
            os.kill(os.getpid(), signal.SIGINT)
        recorder.finish(END)


@pytest.mark.parametrize("held_back", [False, True])
def test_a_run_that_is_to_end_waits_less_for_it(begun, tmp_path, monkeypatch, held_back, interruptible):
    monkeypatch.setattr(patience, "HURRIED_S", 0.3)
    with stopped_amid(tmp_path, begun) as recorder:
        if not held_back:
            recorder.hurry()
        with pytest.raises(KeyboardInterrupt) if held_back else nullcontext():
            finish_once_asked_to_end(recorder, held_back)
    (warning,) = recorder.warnings
    assert warning.text.startswith(STANDS_STILL)
    assert load_run(tmp_path).complete


def test_one_that_stands_still_before_it_is_ready_is_not_waited_for(begun, tmp_path, monkeypatch):
    monkeypatch.setattr(patience, "TAKES_S", 0.3)
    begun.send_signal(signal.SIGSTOP)
    here = recorded(tmp_path / "run")
    assert here.warnings == ()
    assert begun.wait(60) == -signal.SIGKILL
    assert rerun("rrd", "verify", here.rrd).returncode == 0


def test_a_place_that_cannot_be_written_is_told(begun, tmp_path):
    (tmp_path / "run.rrd").mkdir()
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)
        recorder.finish(END)
    (warning,) = recorder.warnings
    assert warning.text.startswith("run.rrd cannot be written: [Errno 21] Is a directory: ")
    assert begun.wait(60) == 1


def test_where_it_does_not_come_up_the_view_is_drawn_here(begun, tmp_path):
    begun.kill()
    there = recorded(tmp_path / "run")
    assert there.warnings == ()
    assert rerun("rrd", "verify", there.rrd).returncode == 0


def test_whoever_wants_no_view_lets_it_go(begun):
    apart._let_go()
    assert begun.wait(60) == -signal.SIGKILL
    assert apart.view_apart(Patience(), Path("nowhere"), HEADER, table(), model()) is None


def test_what_was_handed_on_is_drawn_when_whoever_flew_is_gone(begun, tmp_path):
    rrd = tmp_path / "run.rrd"
    view = apart.view_apart(Patience(), rrd, HEADER, table(), model(), None)
    assert view is not None
    view.tell(END)
    begun.stdin.close()  # as the end of a process does
    begun.wait(60)
    assert rerun("rrd", "verify", rrd).returncode == 0


def test_ctrl_c_is_for_who_flies(begun, tmp_path):
    await_ready(begun)
    begun.send_signal(signal.SIGINT)
    begun.send_signal(signal.SIGTERM)
    time.sleep(0.1)
    assert os.getsid(begun.pid) != os.getsid(0)
    assert recorded(tmp_path / "run").warnings == ()
    assert begun.wait(60) == 0
