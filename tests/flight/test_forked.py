"""A process that is forked off in the middle of everything flies on."""

from __future__ import annotations

import os
import signal
import sys
import threading
from multiprocessing import get_context

import pytest
from support.places import HELIX

from cube_sim.allocation.subset_qp import confirmations
from cube_sim.errors import FlightError
from cube_sim.flight import Flight

SETTINGS = {"duration_s": 3.0, "checks": [{"kind": "allowed_forces"}]}


def flown(flight):
    flight.fly_to_its_end()
    return flight.signals["pose.position"].tobytes(), flight.mission.allocator._allocator.effort.qps


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="nothing is forked there")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
@pytest.mark.parametrize("at_once", [20, 500])
def test_threads_of_the_parent_are_not_waited_for(monkeypatch, at_once):
    """What is being confirmed in a thread is the parent's; what still waits, each of the two confirms."""
    monkeypatch.setattr(confirmations, "CONFIRMED_AT_ONCE", at_once)
    flight = Flight(HELIX, SETTINGS)
    flight.fly(50)
    here, there = get_context("fork").Pipe()
    child = os.fork()
    if child == 0:
        try:
            there.send((flown(flight), flown(Flight(HELIX, SETTINGS))))
        finally:
            os._exit(0)
    try:
        assert here.poll(60.0)
        (going_on, _), (anew, confirmed) = here.recv()
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    mine, _ = flown(flight)
    assert going_on == anew == mine
    assert confirmed == 151


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="nothing is forked there")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_child_of_threads_that_fly_says_no():
    """Whatever they held locked at that moment, it would wait for."""
    own, started, over = Flight(HELIX, SETTINGS), threading.Event(), threading.Event()

    def told(t):
        started.set()
        if over.is_set():
            raise InterruptedError

    def fly():
        flight = Flight(HELIX, {**SETTINGS, "duration_s": 3600.0})
        with pytest.raises(InterruptedError):
            flight.fly_to_its_end(told)

    thread = threading.Thread(target=fly)
    thread.start()
    assert started.wait(120.0)
    here, there = get_context("fork").Pipe()
    child = os.fork()
    if child == 0:
        said = []
        for flies in (lambda: own.fly(50), lambda: own.step(), lambda: Flight(HELIX, SETTINGS)):
            try:
                said.append(flies())
            except FlightError as error:
                said.append(str(error))
        there.send(said)
        os._exit(0)
    over.set()
    try:
        assert here.poll(60.0)
        assert all("forked off while other threads of its parent flew" in line for line in here.recv())
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        thread.join()
    assert own.fly(50).time_s == 1.0
