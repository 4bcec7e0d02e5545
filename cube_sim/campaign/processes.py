"""Samples flown in processes of their own, of which one that dies costs its own sample only."""

from __future__ import annotations

import faulthandler
import os
import signal
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import islice
from math import inf
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Literal

from cube_sim.campaign.sample_flight import FlownSample, SampleFlights, Task, died
from cube_sim.errors import CubeSimError, SweepError

_POOLS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
ONE_THREAD: dict[str, str] = dict.fromkeys(_POOLS, "1")
"""Of libraries that would each start as many threads as there are processors, in every process."""
_SPAWN = get_context("spawn")
LOOK_S, GRACE_S = 0.1, 1.0
"""How often is looked for those that are late, and how long after its limit one still may land by itself [s]."""
_IS_UP = "up"
"""What a process says once it can fly."""
_SHOW = getattr(signal, "SIGUSR1", None)
"""At which it writes down where it is; None on Windows."""


def in_processes(task: Task, samples: Iterable[int], workers: int) -> Iterator[FlownSample]:
    """Fly samples, in the order in which they land; one that goes on after its time limit ends with its process.

    Args:
        task: what is flown.
        samples: their numbers.
        workers: how many fly at a time.

    Raises:
        CubeSimError: a process does not come up.
    """
    waiting = iter(samples)
    with tempfile.TemporaryDirectory(prefix="cube-sim-sweep-") as folder:
        crew: list[_Worker] = []
        try:
            crew += [_Worker(task, Path(folder)).told(k) for k in islice(waiting, workers)]
            while crew:
                ready = wait([worker.connection for worker in crew], None if task.limit_s is None else LOOK_S)
                for place, worker in enumerate(list(crew)):
                    late = worker.connection not in ready and worker.is_late()
                    if worker.connection not in ready and not late:
                        continue
                    landed = None if late else worker.answer()
                    if isinstance(landed, SweepError):
                        raise landed
                    if landed == "goes on":
                        continue
                    if late:
                        where, spent_s = worker.where_it_is(), worker.flying_s
                        yield died(worker.sample, task.too_long, where, worker.drawn, spent_s)
                        worker.kill()
                        crew[place] = _Worker(task, Path(folder))
                    elif landed is None:
                        yield died(worker.sample, worker.how_it_died(), worker.last_words(), worker.drawn)
                        crew[place] = _Worker(task, Path(folder))
                    else:
                        yield landed
                    if (k := next(waiting, None)) is not None:
                        crew[place].told(k)
                    else:
                        crew[place].dismiss()
                crew = [worker for worker in crew if worker.busy]
        finally:
            for worker in crew:
                worker.kill()


class _Worker:
    """A process that flies one sample at a time."""

    _number = 0

    def __init__(self, task: Task, folder: Path) -> None:
        _Worker._number += 1
        self._words = folder / f"{_Worker._number}.txt"
        self._here, there = _SPAWN.Pipe()
        with _environment(ONE_THREAD):
            self._process = _SPAWN.Process(target=_fly_what_is_asked, args=(there, self._words), daemon=True)
            self._process.start()
        there.close()
        self._here.send(task)
        self.sample, self.busy, self._up = -1, False, False
        self.drawn: Mapping[str, Any] = {}
        self._begun, self._most_s = time.monotonic(), inf
        if task.limit_s is not None:  # what fails is flown once more where it is kept
            self._most_s = (1 if task.keep == "none" else 2) * task.limit_s + GRACE_S

    @property
    def connection(self) -> Connection:
        return self._here

    def told(self, k: int) -> _Worker:
        with suppress(BrokenPipeError):  # it has died; that is found when its answer is read
            self._here.send(k)
        self.sample, self.busy, self.drawn, self._begun = k, True, {}, time.monotonic()
        return self

    @property
    def flying_s(self) -> float:
        """For how long it has been at its sample [s]."""
        return time.monotonic() - self._begun

    def is_late(self) -> bool:
        """Whether it goes on after its time; what it takes to come up is not counted."""
        return self._up and self.flying_s > self._most_s

    def where_it_is(self) -> str:
        """The lines of Python at which it is now."""
        if _SHOW is None or self._process.pid is None:
            return ""
        with suppress(ProcessLookupError):
            os.kill(self._process.pid, _SHOW)
        until = time.monotonic() + GRACE_S
        before, now = "", self.last_words()
        while (not now or now != before) and time.monotonic() < until:  # until all of it is written
            time.sleep(0.05)
            before, now = now, self.last_words()
        return now

    def answer(self) -> FlownSample | SweepError | Literal["goes on"] | None:
        """The sample it has flown, or why nothing more can be; None where it has died.

        "goes on" where it has only said that it is up, or what it has drawn.
        """
        try:
            answer = self._here.recv()
            if isinstance(answer, FlownSample | SweepError):
                return answer
            if answer == _IS_UP:
                self._up, self._begun = True, time.monotonic()
            else:
                self.drawn = answer
            return "goes on"
        except (EOFError, ConnectionResetError):
            self._process.join()
            if not self._up:
                raise CubeSimError(f"a process to fly in does not come up: {self.last_words() or 'it ends'}") from None
            return None

    def how_it_died(self) -> str:
        code = self._process.exitcode or 0
        return f"its process died: {signal.Signals(-code).name if code < 0 else f'exit code {code}'}"

    def last_words(self) -> str:
        with suppress(OSError):
            return self._words.read_text(errors="replace").strip()
        return ""

    def dismiss(self) -> None:
        self.busy = False
        self._here.close()
        self._process.join()

    def kill(self) -> None:
        self._process.kill()
        self._process.join()
        self._here.close()


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """What a process that is started meanwhile finds in its environment."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _fly_what_is_asked(connection: Connection, words: Path) -> None:
    """The process: samples until its parent is gone, or has no more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent hears it too, and ends this
    os.dup2(2, 1)  # what code of the user's own prints is none of the command's results
    with words.open("w") as file, suppress(EOFError, OSError):  # its parent is gone
        faulthandler.enable(file)
        if _SHOW is not None:
            faulthandler.register(_SHOW, file, all_threads=False)
        try:
            flights = SampleFlights(connection.recv())
        except Exception as error:
            print(f"{type(error).__name__}: {error}", file=file)
            sys.exit(1)
        connection.send(_IS_UP)
        while True:
            k = connection.recv()
            try:
                connection.send(flights.fly(k, tell=connection.send))
            except SweepError as error:
                connection.send(error)
