"""A sink on a thread of its own: nothing is lost, nothing is out of order, nothing goes wrong in silence."""

from __future__ import annotations

import threading

import pytest

from cube_sim.errors import RecordingError
from cube_sim.recording import beside as beside_module
from cube_sim.recording.batch import Batch
from cube_sim.recording.beside import SinkBeside
from cube_sim.run_log import LogLine


class Slow:
    """Takes its time, and remembers; fails at one batch."""

    def __init__(self, fails_at: float = -1.0) -> None:
        self.taken, self.closed, self.fails_at, self.go_on = [], False, fails_at, threading.Event()

    def write(self, batch: Batch) -> None:
        assert self.go_on.wait(10.0)
        self.taken.append(batch.log[0].t)
        if self.taken[-1] == self.fails_at:
            raise OSError("no room")

    def close(self) -> None:
        self.closed = True


def written(beside):
    """Wait until everything so far is written, or has failed to be."""
    beside._thread.submit(lambda: None).result(10.0)


def batch(t):
    return Batch({}, [LogLine(t, "INFO", "")])


def test_the_writer_goes_on_while_the_sink_writes_and_order_is_kept():
    slow = Slow()
    beside = SinkBeside(lambda: slow)
    for k in range(50):
        beside.write(batch(float(k)))  # returns though the sink waits
    assert slow.taken == []
    slow.go_on.set()
    beside.close()
    assert slow.taken == [float(k) for k in range(50)]
    assert slow.closed


def test_a_writer_far_ahead_waits_for_the_sink(monkeypatch):
    monkeypatch.setattr(beside_module, "MOST_WAITING", 3)
    slow = Slow()
    beside = SinkBeside(lambda: slow)
    writer = threading.Thread(target=lambda: [beside.write(batch(float(k))) for k in range(10)])
    writer.start()
    writer.join(0.3)
    assert writer.is_alive()
    assert len(beside._writing) <= 3
    slow.go_on.set()
    writer.join(10.0)
    beside.close()
    assert slow.taken == [float(k) for k in range(10)]


def test_what_goes_wrong_is_raised_at_the_next_call_and_the_sink_is_closed():
    slow = Slow(fails_at=1.0)
    slow.go_on.set()
    beside = SinkBeside(lambda: slow)
    beside.write(batch(0.0))
    beside.write(batch(1.0))
    written(beside)
    with pytest.raises(OSError, match="no room"):
        beside.write(batch(2.0))
    beside.write(batch(3.0))
    beside.close()
    assert slow.taken == [0.0, 1.0, 3.0]
    assert slow.closed
    failing = Slow(fails_at=0.0)
    last = SinkBeside(lambda: failing)
    failing.go_on.set()
    last.write(batch(0.0))
    with pytest.raises(OSError, match="no room"):
        last.close()
    assert failing.closed


def test_what_cannot_be_made_is_said():
    def make():
        raise OSError("no place")

    beside = SinkBeside(make)
    beside.write(batch(0.0))
    with pytest.raises(OSError, match="no place"):
        beside.close()


def test_what_the_viewers_library_says_of_a_full_disk_is_a_recording_error():
    slow = Slow()
    slow.write = lambda _: (_ for _ in ()).throw(RuntimeError("No space left"))
    beside = SinkBeside(lambda: slow)
    beside.write(batch(0.0))
    with pytest.raises(RecordingError, match="No space left"):
        beside.close()
    assert slow.closed


def test_a_view_that_cannot_be_finished_is_an_error_of_the_recording():
    """Its last piece, the only one of a short flight, is written when it is closed."""

    class Full(Slow):
        def close(self) -> None:
            raise RuntimeError("no space left on device")

    beside = SinkBeside(Full)
    with pytest.raises(RecordingError, match="the view cannot be written: no space left on device"):
        beside.close()
