"""Answers confirmed by ProxQP beside the flight that goes on with them."""

from __future__ import annotations

import os
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.subset_qp.confirmer import Confirmer

CONFIRMED_AT_ONCE = 500
"""So many answers wait to be confirmed together: two threads of Python that take turns often hold each other up."""


@cache
def _beside(process: int) -> ThreadPoolExecutor:
    """The thread of a process, by its number, on which answers are confirmed while flights go on.

    One that has been forked off has its parent's memory, and none of its threads.
    """
    return ThreadPoolExecutor(1, f"confirming {process}")


class Confirmations:
    """One allocator's answers as ProxQP sees them: some at once, some many at a time on another thread.

    Args:
        confirmer: solves the subset of one answer.
    """

    def __init__(self, confirmer: Confirmer) -> None:
        self._confirmer = confirmer
        self._waiting: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        self._running: tuple[int, Future[None]] | None = None
        self._asked = self._refused = 0

    def now(self, row: NDArray[np.float64], demand: NDArray[np.float64]) -> None:
        """Confirm one answer, see `answer_of`, to a demand (n,)."""
        self._wait()  # one solver, one thread at a time
        self._ask(row, demand)

    def later(self, rows: NDArray[np.float64], demands: NDArray[np.float64]) -> None:
        """Let N answers wait to be confirmed, see `go_on`.

        Args:
            rows: (N, answer size) answers, see `answer_of`; not to be changed any more.
            demands: (N, n) that they answer, likewise.
        """
        if len(rows):
            self._waiting.append((rows, demands))

    def go_on(self) -> None:
        """Confirm what waits, once it is worth it, while the caller flies on.

        Best called just before code that lets other threads have Python: the two would hold each other up.
        """
        if sum(len(answers) for answers, _ in self._waiting) >= CONFIRMED_AT_ONCE:
            self._wait()
            process, waiting, self._waiting = os.getpid(), self._waiting, []
            self._running = process, _beside(process).submit(self._confirm, waiting)

    def settle(self) -> tuple[int, int]:
        """Confirm whatever waits.

        Returns:
            How many answers were confirmed or refused since the last call, and how many refused.
        """
        self._wait()
        waiting, self._waiting = self._waiting, []
        self._confirm(waiting)
        counted = self._asked, self._refused
        self._asked = self._refused = 0
        return counted

    def _wait(self) -> None:
        running, self._running = self._running, None
        if running is not None and running[0] == os.getpid():
            running[1].result()

    def _confirm(self, answered: list[tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
        for rows, demands in answered:
            for row, demand in zip(rows, demands, strict=True):
                self._ask(row, demand)

    def _ask(self, row: NDArray[np.float64], demand: NDArray[np.float64]) -> None:
        self._asked += 1
        self._refused += not self._confirmer.confirms(row, demand)
