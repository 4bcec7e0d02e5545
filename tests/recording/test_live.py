"""A viewer that is absent, lags or dies in mid-flight: the record is the same to the byte, and nobody waits."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from support.helix_run import END, HEADER, fly, model, table

from cube_sim import load_run
from cube_sim.recording import live as live_module
from cube_sim.recording.batch import Batch
from cube_sim.recording.live import LiveSink, somebody_listens
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.rerun.viewer import free_port, start
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import LogLine


def batch(t):
    return Batch({}, [LogLine(t, "INFO", "")])


class Shown:
    """Waits before it takes anything; fails at one batch."""

    def __init__(self, fails_at: float = -1.0) -> None:
        self.taken, self.closed, self.fails_at, self.go_on = [], False, fails_at, threading.Event()
        self.told = []

    def write(self, batch: Batch) -> None:
        self.go_on.wait(10.0)
        if batch.log[0].t == self.fails_at:
            raise OSError("the viewer is gone")
        self.taken.append(batch.log[0].t)

    def tell(self, end: RunEnd) -> None:
        self.told.append((end, len(self.taken)))

    def close(self) -> None:
        self.closed = True


def test_a_viewer_that_keeps_up_sees_everything():
    shown = Shown()
    shown.go_on.set()
    sink = LiveSink(lambda: shown)
    for k in range(20):
        sink.write(batch(float(k)))
    sink.tell(END)
    sink.close()
    assert (shown.taken, shown.closed, sink.left_out) == ([float(k) for k in range(20)], True, 0)
    assert shown.told == [(END, 20)]


def test_nobody_waits_for_a_viewer_that_lags(monkeypatch):
    monkeypatch.setattr(live_module, "PATIENCE_S", 0.05)
    shown = Shown()
    sink = LiveSink(lambda: shown)
    started = time.monotonic()
    for k in range(live_module.MOST_WAITING + 30):
        sink.write(batch(float(k)))
    sink.close()
    assert time.monotonic() - started < 2.0
    assert sink.left_out in (29, 30)  # one may be in its hands already
    shown.go_on.set()


@pytest.mark.parametrize("make", [lambda: Shown(fails_at=1.0), lambda: 1 / 0])
def test_a_viewer_that_fails_is_left_behind(make):
    sink = LiveSink(make)
    for k in range(5):
        sink.write(batch(float(k)))
    sink.close()


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    with Recorder(tmp_path_factory.mktemp("alone"), HEADER, table(), model(), view=False) as recorder:
        fly(recorder, 300)
    return recorder.mcap.read_bytes()


def recorded(folder, port, meanwhile=lambda: None):
    with Recorder(folder, HEADER, table(), model(), view=False, live=port) as recorder:
        fly(recorder, 150)
        meanwhile()
        fly(recorder, 150, 150)
    return recorder.mcap.read_bytes()


def test_without_a_viewer_the_record_is_the_same(alone, tmp_path):
    port = free_port()
    assert not somebody_listens(port)
    started = time.monotonic()
    assert recorded(tmp_path, port) == alone
    assert time.monotonic() - started < 30


@pytest.mark.flight
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_a_viewer_that_dies_or_stops_in_mid_flight_changes_nothing(how, alone, tmp_path):
    port = free_port()
    viewer = start(["--serve-grpc"], port)
    try:
        deadline = time.monotonic() + 60
        while not somebody_listens(port):
            assert time.monotonic() < deadline
            time.sleep(0.1)
        started = time.monotonic()
        assert recorded(tmp_path, port, lambda: viewer.send_signal(how)) == alone
        assert time.monotonic() - started < 30
    finally:
        viewer.kill()
        viewer.wait(timeout=30)


ENDS = """
import sys
from pathlib import Path
from support.helix_run import END, HEADER, fly, model, table
from cube_sim.recording.recorder import Recorder
with Recorder(Path(sys.argv[1]), HEADER, table(), model(), view=False, live=int(sys.argv[2])) as recorder:
    fly(recorder, 60)
    print("flown", flush=True)
    sys.stdin.readline()
    fly(recorder, 60, 60)
    recorder.finish(END)
"""


@pytest.mark.flight
def test_a_process_ends_beside_a_viewer_that_has_stopped(tmp_path):
    port = free_port()
    viewer = start(["--serve-grpc"], port)
    command = [sys.executable, "-c", ENDS, str(tmp_path), str(port)]
    paths = os.pathsep.join(sys.path)
    try:
        while not somebody_listens(port):
            time.sleep(0.1)
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        with subprocess.Popen(command, text=True, env={**os.environ, "PYTHONPATH": paths}, **pipes) as process:
            try:
                assert process.stdout.readline() == "flown\n"
                viewer.send_signal(signal.SIGSTOP)
                process.communicate("\n", timeout=60)
                assert process.returncode == 0
            finally:
                process.kill()
    finally:
        viewer.kill()
        viewer.wait(timeout=30)
    assert load_run(tmp_path).complete
