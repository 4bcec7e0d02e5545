"""Signals that come amid a piece of work, and what becomes of them once there is something to bring to an end."""

from __future__ import annotations

import os
import signal
from contextlib import ExitStack

import pytest

from cube_sim.uninterrupted import GIVES_WAY, TERMINATIONS, signal_of, stoppable, uninterrupted

ALL = (signal.SIGINT, *TERMINATIONS)


@pytest.fixture
def left(monkeypatch):
    """What a handler that ends the process at once would have been told; it gives way."""
    told = []

    def leave(number, _):
        told.append(number)

    setattr(leave, GIVES_WAY, True)
    before = {number: signal.signal(number, leave) for number in ALL}
    yield told
    for number, handler in before.items():
        signal.signal(number, handler)


def begin_amid(number, passed, first):
    """Have something to end amid two pieces, one in the other; the signal comes before or after that."""
    with ExitStack() as ends, uninterrupted():
        with uninterrupted(start_up=True):
            if first:
                os.kill(os.getpid(), number)
            ends.enter_context(stoppable())
            if not first:
                os.kill(os.getpid(), number)
        passed.append("inner")
    passed.append("outer")


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("number", ALL)
def test_what_comes_amid_pieces_stops_the_work_once_the_outermost_is_over(left, number, first):
    passed = []
    with pytest.raises(KeyboardInterrupt) as stopped:
        begin_amid(number, passed, first)
    assert signal_of(stopped.value) == number
    assert (passed, left) == (["inner"], [])


@pytest.mark.parametrize("number", ALL)
def test_without_anything_to_bring_to_an_end_it_ends_the_process_after_the_piece(left, number):
    with uninterrupted():
        with uninterrupted(start_up=True):
            os.kill(os.getpid(), number)
            assert left == []
        assert left == [number]
