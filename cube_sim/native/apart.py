"""Compiling large functions in another process, beside what this one compiles: the compiler itself takes one core."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import threading
from contextlib import suppress

_running: dict[str, subprocess.Popen[bytes]] = {}


def begin(*functions: str) -> None:
    """Let another process call functions, one after the other, which leave their machine code on disk.

    Nothing depends on it: what it does not leave behind is compiled here. It goes on when this process has come to its
    end, and ends with it when it is killed.

    Args:
        functions: "module:name" each, without arguments.
    """
    if functions[0] in _running or (os.cpu_count() or 1) < 2:
        return
    parts = [function.split(":") for function in functions]
    calls = [f"from {module} import {name}; {name}()" for module, name in parts]
    command = [sys.executable, "-c", "\n".join([f"from {__name__} import watch_parent; watch_parent()", *calls])]
    silent = {"stdin": subprocess.PIPE, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        process = subprocess.Popen(command, **silent)  # type: ignore[call-overload]
    except OSError:
        return
    atexit.register(_take_leave, process)
    _running.update(dict.fromkeys(functions, process))


def finish(function: str) -> None:
    """Wait until the other process has come to its end, if there is one."""
    if function in _running:
        _running.pop(function).wait()


def watch_parent() -> None:
    """In the other process: end it when its parent is gone without a word."""
    threading.Thread(target=_wait_for_word, daemon=True).start()


def _wait_for_word() -> None:
    if not os.read(0, 1):
        os._exit(1)


def _take_leave(process: subprocess.Popen[bytes]) -> None:
    """At the end of this process: the other one may go on alone."""
    if process.stdin is not None:
        with suppress(OSError, ValueError):  # it has come to its end before
            os.write(process.stdin.fileno(), b".")
