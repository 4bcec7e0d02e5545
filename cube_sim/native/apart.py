"""Compiling large functions in another process, beside what this one compiles: the compiler itself takes one core."""

from __future__ import annotations

import os
import subprocess
import sys

_running: dict[str, subprocess.Popen[bytes]] = {}


def begin(function: str) -> None:
    """Let another process call a function, which leaves its machine code on disk.

    Nothing depends on it: what it does not leave behind is compiled here.

    Args:
        function: "module:name", without arguments.
    """
    if function in _running or (os.cpu_count() or 1) < 2:
        return
    module, name = function.split(":")
    command = [sys.executable, "-c", f"from {module} import {name}; {name}()"]
    silent = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        _running[function] = subprocess.Popen(command, **silent)  # type: ignore[call-overload]
    except OSError:
        return


def finish(function: str) -> None:
    """Wait until the other process has come to its end, if there is one."""
    if function in _running:
        _running.pop(function).wait()
