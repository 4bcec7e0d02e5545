"""Samples flown on threads of this process: compiled flights need no interpreter, and fly beside each other."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from itertools import islice

from cube_sim.campaign.sample_flight import FlownSample, SampleFlights, Task
from cube_sim.many_flights import StoppedFlightError

AHEAD = 2
"""So many samples wait for each thread, that none waits for one."""


def on_threads(task: Task, samples: Iterable[int], workers: int) -> Iterator[FlownSample]:
    """Fly samples, in the order in which they land.

    Args:
        task: what is flown.
        samples: their numbers.
        workers: how many fly at a time.
    """
    flights, stop, waiting = SampleFlights(task), threading.Event(), iter(samples)
    with ThreadPoolExecutor(workers) as pool:
        asked: set[Future[FlownSample]] = set()
        try:
            while True:
                asked |= {pool.submit(flights.fly, k, stop) for k in islice(waiting, AHEAD * workers - len(asked))}
                if not asked:
                    return
                done, asked = wait(asked, return_when=FIRST_COMPLETED)
                for each in sorted(done, key=lambda future: future.result().index):
                    yield each.result()
        finally:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            for each in asked:
                with suppress(StoppedFlightError, BaseException):
                    each.cancel()
