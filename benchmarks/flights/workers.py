"""Flights in processes of their own, of which one that hangs or dies costs its own flight only."""

from __future__ import annotations

import math
import resource
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any

_SPAWN = get_context("spawn")


class _Worker:
    """A process that answers one call at a time."""

    def __init__(self) -> None:
        self._here, there = _SPAWN.Pipe()
        self._process = _SPAWN.Process(target=_answer, args=(there,), daemon=True)
        self._process.start()
        there.close()
        self.index: int | None = None
        self.deadline = 0.0

    @property
    def connection(self) -> Connection:
        return self._here

    def ask(self, index: int, call: Callable[..., Any], arguments: tuple, cpu_s: float, wall_s: float) -> None:
        self.index, self.deadline = index, time.monotonic() + wall_s
        self._here.send((call, arguments, cpu_s))

    def answer(self) -> tuple[bool, Any]:
        try:
            return self._here.recv()
        except EOFError:
            self._process.join()
            if self._process.exitcode == -signal.SIGXCPU:
                return False, "timeout: it took all its processor time"
            return False, "crash: the process died"

    def stop(self) -> None:
        self._process.kill()
        self._process.join()
        self._here.close()


def in_processes(
    call: Callable[..., Any], every: Sequence[tuple], *, jobs: int, cpu_s: float, wall_s: float
) -> Iterator[tuple[int, bool, Any]]:
    """Yield (index, whether it returned, what it returned or one line of why not) in the order of ending.

    Args:
        call: at the top of a module, so that another process finds it.
        every: its arguments, one tuple for each call.
        jobs: processes at a time.
        cpu_s: processor time of a call [s], beyond which it is given up; a busy machine does not count.
        wall_s: the same of the clock, for a call that waits for ever.
    """
    waiting = list(enumerate(every))[::-1]
    workers = [_Worker() for _ in range(min(jobs, len(waiting)))]
    try:
        busy: list[_Worker] = []
        for worker in workers:
            _next(worker, call, waiting, busy, cpu_s, wall_s)
        while busy:
            ready = wait([w.connection for w in busy], timeout=1.0)
            for worker in list(busy):
                late = time.monotonic() > worker.deadline
                if worker.connection not in ready and not late:
                    continue
                index = worker.index
                assert index is not None
                good, value = worker.answer() if worker.connection in ready else (False, f"timeout: {wall_s:g} s")
                busy.remove(worker)
                if late or str(value).startswith(("crash", "timeout")):
                    worker.stop()
                    workers.remove(worker)
                    worker = _Worker()
                    workers.append(worker)
                _next(worker, call, waiting, busy, cpu_s, wall_s)
                yield index, good, value
    finally:
        for worker in workers:
            worker.stop()


def _next(
    worker: _Worker, call: Callable[..., Any], waiting: list, busy: list[_Worker], cpu_s: float, wall_s: float
) -> None:
    if waiting:
        index, arguments = waiting.pop()
        worker.ask(index, call, arguments, cpu_s, wall_s)
        busy.append(worker)


def _answer(connection: Connection) -> None:
    """The process: calls until its parent is gone."""
    while True:
        try:
            call, arguments, cpu_s = connection.recv()
        except EOFError:
            return
        # The system ends a process that uses more, also inside compiled code.
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + cpu_s), hard))
        try:
            said = True, call(*arguments)
        except Exception as error:
            text = " ".join(str(error).split())
            said = False, f"{type(error).__name__}: {text[:300]}"
        connection.send(said)
