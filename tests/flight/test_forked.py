"""A process that is forked off in the middle of everything flies on."""

from __future__ import annotations

import os
import signal
import sys
from multiprocessing import get_context

import pytest
from support.places import HELIX

from cube_sim.allocation.subset_qp import confirmations
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
