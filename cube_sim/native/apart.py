"""Compiling large functions in other processes, beside each other: the compiler itself takes one core.

They share one queue. So whoever is done with one function takes the next, and none waits for the other.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module

PROCESSES = 2
"""As many compile: the functions are few, and each takes its own memory (a choice)."""


class Compilers:
    """Processes that call functions, which leave their machine code on disk, and what is known of them.

    Args:
        functions: "module:name" each, without arguments; the longest first.
        count: of the processes, at most as many as functions.
    """

    def __init__(self, functions: Sequence[str], count: int) -> None:
        self._functions, self._done, self._reading = tuple(functions), set[str](), threading.Lock()
        queue, into = os.pipe()
        self._answers, done = os.pipe()
        try:
            os.write(into, bytes(range(len(functions))))
            command = [sys.executable, "-c", f"from {__name__} import work; work({queue}, {done})", *functions]
            kept = {"stdin": subprocess.PIPE, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
            self.processes = [
                subprocess.Popen(command, pass_fds=(queue, done), **kept)  # type: ignore[call-overload]
                for _ in range(min(count, len(functions)))
            ]
        finally:
            for end in (queue, into, done):  # what is in the queue stays there as long as one of them reads it
                os.close(end)
        atexit.register(self._take_leave)

    def wait_for(self, function: str) -> None:
        """Until a function has been called, or nobody is left to call it."""
        while function not in self._done:
            with self._reading:
                if function in self._done:
                    return
                number = os.read(self._answers, 1)
                self._done.update([self._functions[number[0]]] if number else self._functions)

    def _take_leave(self) -> None:
        """At the end of this process: the others may go on alone."""
        for process in self.processes:
            if process.stdin is not None:
                with suppress(OSError, ValueError):  # it has come to its end before
                    os.write(process.stdin.fileno(), b".")


_running: dict[str, Compilers] = {}


def begin(*functions: str) -> None:
    """Let other processes call functions, which leave their machine code on disk.

    Nothing depends on it: what they do not leave behind is compiled here. They go on when this process has come to its
    end, and end with it when it is killed.

    Args:
        functions: "module:name" each, without arguments; those that take longest first.
    """
    if functions[0] in _running or (os.cpu_count() or 1) < 2 or os.name != "posix":
        return
    with suppress(OSError):
        _running.update(dict.fromkeys(functions, Compilers(functions, PROCESSES)))


def finish(function: str) -> None:
    """Wait until another process has called a function, if there is one that does."""
    if function in _running:
        _running[function].wait_for(function)


def work(queue: int, done: int) -> None:
    """In one of the other processes: call what is in the queue, one after the other, and end when the parent is gone.

    Args:
        queue: where numbers of functions come from, a byte each.
        done: where they go when the function has been called.
    """
    threading.Thread(target=_wait_for_word, daemon=True).start()
    functions = sys.argv[1:]
    while number := os.read(queue, 1):
        module, _, name = functions[number[0]].partition(":")
        with suppress(Exception):  # it is compiled by whoever needs it, and fails there with a sentence
            getattr(import_module(module), name)()
        with suppress(OSError):  # the parent is gone
            os.write(done, number)


def _wait_for_word() -> None:
    if not os.read(0, 1):
        os._exit(1)
