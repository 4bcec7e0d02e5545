"""A sink on a thread of its own: nothing is lost, nothing is out of order, nothing goes wrong in silence."""

from __future__ import annotations

import threading

from support.helix_run import END

from cube_sim.recording import beside as beside_module
from cube_sim.recording.batch import Batch
from cube_sim.recording.beside import SinkBeside
from cube_sim.recording.run_end import RunEnd
from cube_sim.run_log import LogLine


class Slow:
    """Takes its time, and remembers; fails at one batch."""

    def __init__(self, fails_at: float = -1.0) -> None:
        self.taken, self.closed, self.fails_at, self.go_on = [], False, fails_at, threading.Event()
        self.told = []

    def write(self, batch: Batch) -> None:
        assert self.go_on.wait(10.0)
        self.taken.append(batch.log[0].t)
        if self.taken[-1] == self.fails_at:
            raise OSError("no room")

    def tell(self, end: RunEnd) -> None:
        self.told.append((end, len(self.taken)))

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


def test_how_the_run_ended_comes_after_all_else():
    slow = Slow()
    beside = SinkBeside(lambda: slow)
    beside.write(batch(0.0))
    beside.tell(END)
    slow.go_on.set()
    beside.close()
    assert (slow.taken, slow.told) == ([0.0], [(END, 1)])


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


def test_what_goes_wrong_ends_the_sink_alone_and_is_told():
    slow = Slow(fails_at=1.0)
    slow.go_on.set()
    beside = SinkBeside(lambda: slow)
    for k in range(4):
        beside.write(batch(float(k)))
        written(beside)
    assert slow.taken == [0.0, 1.0]
    assert beside.failure == "no room"
    beside.close()
    assert slow.closed
    failing = Slow(fails_at=0.0)
    last = SinkBeside(lambda: failing)
    failing.go_on.set()
    last.write(batch(0.0))
    last.close()
    assert last.failure == "no room"
    assert failing.closed


def test_what_cannot_be_made_is_told():
    def make():
        raise RuntimeError("no place\nat all")

    beside = SinkBeside(make)
    beside.write(batch(0.0))
    beside.close()
    assert beside.failure == "no place at all"


def test_a_view_that_cannot_be_finished_is_told():
    """Its last piece, the only one of a short flight, is written when it is closed."""

    class Full(Slow):
        def close(self) -> None:
            raise RuntimeError("no space left on device")

    beside = SinkBeside(Full)
    beside.close()
    assert beside.failure == "no space left on device"
