"""A flight whose seconds are recorded while a thread flies the next ones."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from support.places import HELIX, SCENARIOS

from cube_sim.errors import RecordingError
from cube_sim.flight import Loop, loop
from cube_sim.mission import prepare
from cube_sim.mission.run_header import header
from cube_sim.recording.reading import read_signals
from cube_sim.recording.recorder import Recorder
from cube_sim.scenario import load

CHECKS = [{"kind": "allowed_forces"}]
SHORT = {"duration_s": 20.0, "checks": CHECKS}
DEAD = {"kind": "thrusters", "at_s": 6.5, "thrusters": ["T3"], "state": "dead"}


def recorded(scenario, settings, folder):
    """A flight about to begin, and its recorder."""
    loaded = load(scenario, settings)
    mission = prepare(loaded)
    folder.mkdir()
    recorder = Recorder(folder, header(loaded), mission.channels, mission.model, False, mission.vehicle.name)
    return Loop(mission, recorder), recorder


def flown(scenario, settings, folder):
    """Bytes of the record of a whole flight."""
    flight, recorder = recorded(scenario, settings, folder)
    with recorder:
        flight.fly_to_its_end()
    return recorder.mcap.read_bytes()


def flying_threads():
    return [thread for thread in threading.enumerate() if thread.name == "flying"]


@pytest.mark.flight
@pytest.mark.parametrize(
    ("name", "events"),
    [("cube_helix", [DEAD]), ("cube_navigated", []), ("bluerov2_battery", []), ("infante_circle", [])],
)
def test_the_record_does_not_know_how_it_was_flown(name, events, tmp_path, monkeypatch):
    """The same bytes from the flight's own thread, and from stretches of any length on another."""
    scenario, settings = SCENARIOS / f"{name}.yaml", {**SHORT, "events": events}
    beside = flown(scenario, settings, tmp_path / "beside")
    with monkeypatch.context() as patch:
        patch.setattr(Recorder, "writes", False)
        assert flown(scenario, settings, tmp_path / "alone") == beside
    monkeypatch.setattr(loop, "FEW_TICKS", 37)
    monkeypatch.setattr(loop, "MANY_TICKS", 211)
    assert flown(scenario, settings, tmp_path / "pieces") == beside


@pytest.mark.flight
def test_what_stops_a_flight_leaves_it_whole(tmp_path):
    """Whatever the caller raises when it is told: all that was flown is recorded, and the flight can go on."""
    long = {**SHORT, "duration_s": 200.0}  # on a busy machine a flight is far ahead of who looks
    whole, at = flown(HELIX, long, tmp_path / "whole"), []

    def told(t):
        if t > 12.0 and not at:
            at.append(t)
            raise KeyboardInterrupt

    flight, recorder = recorded(HELIX, long, tmp_path / "halted")
    with recorder:
        with pytest.raises(KeyboardInterrupt):
            flight.fly_to_its_end(told)
        assert not flying_threads()
        assert at[0] <= flight.time_s < 200.0
        assert recorder.signals["pose.position"][-1, 0] == pytest.approx(flight.time_s - 0.02)
        flight.fly_to_its_end(told)
    assert recorder.mcap.read_bytes() == whole


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="no such signal there")
def test_an_interrupt_is_heard_within_a_stretch(tmp_path, monkeypatch):
    """The parts of a flight go on together; nobody waits for the end of a long stretch."""
    monkeypatch.setattr(loop, "FEW_TICKS", 100_000)
    flight, recorder = recorded(HELIX, {"duration_s": 2000.0, "checks": CHECKS}, tmp_path / "run")
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    try:
        flight.go_on(50)
        timer.start()
        with recorder, pytest.raises(KeyboardInterrupt):
            flight.go_on(100_000)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert 1.0 < flight.time_s < 1000.0
    assert read_signals(recorder.mcap)["pose.position"][-1, 0] == pytest.approx(flight.time_s - 0.02)


@pytest.mark.flight
def test_a_record_that_cannot_be_written_ends_the_flight(tmp_path):
    flight, recorder = recorded(HELIX, SHORT, tmp_path / "run")
    (sink,) = recorder._sinks
    write, batches = sink.write, []

    def full(batch):
        batches.append(batch)
        if len(batches) > 4:
            raise RecordingError("the disk is full")
        write(batch)

    sink.write = full
    with pytest.raises(RecordingError, match="the disk is full"):
        flight.fly_to_its_end()
    assert not flying_threads()
    assert flight.time_s < 20.0


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="no such signal there")
def test_what_was_told_outlives_a_kill(tmp_path):
    """A second is in the file before anybody hears of it."""
    program = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from flight.test_beside import HELIX, CHECKS, recorded\n"
        "flight, recorder = recorded(HELIX, {'duration_s': 600.0, 'checks': CHECKS}, Path(sys.argv[1]))\n"
        "def told(t):\n"
        "    if t > 30.0:\n"
        "        print(t, flush=True)\n"
        "        os.kill(os.getpid(), signal.SIGKILL)\n"
        "flight.fly_to_its_end(told)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path])}
    given = [sys.executable, "-c", program, str(tmp_path / "run")]
    ended = subprocess.run(given, env=environment, timeout=120, capture_output=True, text=True)
    assert ended.returncode == -signal.SIGKILL, ended.stderr
    kept = read_signals(tmp_path / "run" / "run.mcap")["pose.position"]
    assert kept[-1, 0] >= float(ended.stdout) - 1.0 / 50.0 - 1e-9
